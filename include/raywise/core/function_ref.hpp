// A borrowed callable: two words, no allocation. For parameters that are called before the function
// returns.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace raywise {

template <class Signature>
class FunctionRef;

/// Refers to a callable without owning it; the callable must outlive the reference, as a function
/// argument does.
template <class Result, class... Args>
class FunctionRef<Result(Args...)> {
public:
    template <class Callable>
        requires(!std::is_same_v<std::remove_cvref_t<Callable>, FunctionRef> &&
                 std::is_invocable_r_v<Result, Callable&, Args...>)
    // NOLINTNEXTLINE(google-explicit-constructor,bugprone-forwarding-reference-overload): borrowing
    // is the point.
    FunctionRef(Callable&& callable)
        : object_(const_cast<void*>(static_cast<const void*>(std::addressof(callable))))
        , call_([](void* object, Args... args) -> Result {
            return (*static_cast<std::remove_reference_t<Callable>*>(object))(
                std::forward<Args>(args)...
            );
        }) {}

    Result operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

private:
    void* object_;
    Result (*call_)(void*, Args...);
};

} // namespace raywise
