// Exact arithmetic on sums of doubles, of fixed capacity. After [Shewchuk97].
#pragma once

#include <array>
#include <cstddef>

namespace raywise::detail {

/// An exact number: the sum of nonoverlapping doubles by increasing magnitude, none zero. Needs
/// round-to-nearest and no contraction, and operands small and large enough that no product under-
/// or overflows: products of up to five floats qualify.
template <std::size_t Capacity>
// NOLINTNEXTLINE(cppcoreguidelines-special-member-functions): a move is a copy.
class Expansion {
public:
    Expansion() {} // NOLINT(*-member-init,*-use-equals-default): only [0, size) is ever read

    Expansion(const Expansion& other) : size_(other.size_) { copy_terms(other); }

    template <std::size_t Fewer>
        requires(Fewer < Capacity)
    explicit Expansion(const Expansion<Fewer>& other) : size_(other.size()) {
        copy_terms(other);
    }

    Expansion& operator=(const Expansion& other) {
        size_ = other.size_;
        if (this != &other) copy_terms(other);
        return *this;
    }

    ~Expansion() = default;

    [[nodiscard]] std::size_t size() const { return size_; }

    [[nodiscard]] double operator[](std::size_t i) const { return terms_[i]; }

    [[nodiscard]] double& operator[](std::size_t i) { return terms_[i]; }

    void append(double term) {
        if (term != 0) terms_[size_++] = term;
    }

    void clear() { size_ = 0; }

    /// -1, 0 or 1.
    [[nodiscard]] int sign() const {
        if (size_ == 0) return 0;
        return terms_[size_ - 1] > 0 ? 1 : -1;
    }

    /// Within 2^-51 of the value, relatively.
    [[nodiscard]] double estimate() const {
        double sum = 0;
        for (std::size_t i = 0; i < size_; ++i)
            sum += terms_[i];
        return sum;
    }

private:
    template <std::size_t Other>
    void copy_terms(const Expansion<Other>& other) {
        for (std::size_t i = 0; i < size_; ++i)
            terms_[i] = other[i];
    }

    std::array<double, Capacity> terms_;
    std::size_t size_ = 0;
};

struct TwoTerms {
    double high;
    double low;
};

/// high + low = a + b exactly, high = fl(a + b). [Shewchuk97, theorem 7]
inline TwoTerms two_sum(double a, double b) {
    const double high = a + b;
    const double b_part = high - a;
    const double a_part = high - b_part;
    return {high, (a - a_part) + (b - b_part)};
}

/// two_sum for |a| >= |b|. [Shewchuk97, theorem 6]
inline TwoTerms fast_two_sum(double a, double b) {
    const double high = a + b;
    return {high, b - (high - a)};
}

/// high + low = a * b exactly, by splitting each factor in halves. [Shewchuk97, theorems 17, 18]
inline TwoTerms two_product(double a, double b) {
    constexpr double splitter = 134217729.0; // 2^27 + 1
    const double high = a * b;
    const double a_scaled = splitter * a;
    const double a_high = a_scaled - (a_scaled - a);
    const double a_low = a - a_high;
    const double b_scaled = splitter * b;
    const double b_high = b_scaled - (b_scaled - b);
    const double b_low = b - b_high;
    const double error = ((high - a_high * b_high) - a_low * b_high) - a_high * b_low;
    return {high, a_low * b_low - error};
}

/// a - b, of floats or doubles.
template <class T>
Expansion<2> difference(T a, T b) {
    const TwoTerms d = two_sum(static_cast<double>(a), -static_cast<double>(b));
    Expansion<2> e;
    e.append(d.low);
    e.append(d.high);
    return e;
}

template <std::size_t N>
Expansion<N> operator-(Expansion<N> a) {
    for (std::size_t i = 0; i < a.size(); ++i)
        a[i] = -a[i];
    return a;
}

/// Adds the terms of b one by one to the whole of a. Quadratic, but it asks no more of its operands
/// than what it returns. [Shewchuk97, theorems 10, 12]
template <std::size_t N, std::size_t M>
Expansion<N + M> operator+(const Expansion<N>& a, const Expansion<M>& b) {
    Expansion<N + M> sum(a);
    for (std::size_t j = 0; j < b.size(); ++j) {
        double carry = b[j];
        const std::size_t old_size = sum.size();
        sum.clear(); // each term is read before the shorter result overwrites it
        for (std::size_t i = 0; i < old_size; ++i) {
            const TwoTerms s = two_sum(carry, sum[i]);
            carry = s.high;
            sum.append(s.low);
        }
        sum.append(carry);
    }
    return sum;
}

template <std::size_t N, std::size_t M>
Expansion<N + M> operator-(const Expansion<N>& a, const Expansion<M>& b) {
    return a + -b;
}

/// [Shewchuk97, theorem 19]
template <std::size_t N>
Expansion<2 * N> operator*(const Expansion<N>& a, double factor) {
    Expansion<2 * N> product;
    double carry = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const TwoTerms p = two_product(a[i], factor);
        const TwoTerms low = two_sum(carry, p.low);
        product.append(low.low);
        const TwoTerms high = fast_two_sum(p.high, low.high);
        product.append(high.low);
        carry = high.high;
    }
    product.append(carry);
    return product;
}

template <std::size_t N>
Expansion<4 * N> operator*(const Expansion<N>& a, const Expansion<2>& b) {
    if (b.size() == 0) return {};
    const Expansion<2 * N> first = a * b[0];
    return b.size() == 1 ? Expansion<4 * N>(first) : first + a * b[1];
}

/// The same number in as few terms as it takes, each nearly as long as a double can be.
/// [Shewchuk97, theorem 23]
template <std::size_t N>
Expansion<N> compress(const Expansion<N>& a) {
    if (a.size() == 0) return a;
    std::array<double, N> downward; // NOLINT(*-member-init): written before read
    std::size_t bottom = a.size() - 1;
    double carry = a[bottom];
    for (std::size_t i = a.size() - 1; i-- > 0;) {
        const TwoTerms s = fast_two_sum(carry, a[i]);
        if (s.low != 0) {
            downward[bottom--] = s.high;
            carry = s.low;
        } else {
            carry = s.high;
        }
    }
    downward[bottom] = carry;
    Expansion<N> result;
    for (std::size_t i = bottom + 1; i < a.size(); ++i) {
        const TwoTerms s = fast_two_sum(downward[i], carry);
        result.append(s.low);
        carry = s.high;
    }
    result.append(carry);
    return result;
}

} // namespace raywise::detail
