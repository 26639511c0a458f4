// An include that the layer check must refuse.
#include <raywise/build/binned.hpp>
