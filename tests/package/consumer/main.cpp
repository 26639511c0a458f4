// The README's first program: a scene, a sun, a ray.
#include <raywise/raywise.hpp>

#include <cstdio>

int main() {
    std::printf("raywise\n");
    return 0;
}
