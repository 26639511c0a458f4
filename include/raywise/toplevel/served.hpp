// Who watches a query of the accelerator: nobody, or a report of which trees were searched, where,
// and who answered.
#pragma once

#include <raywise/core/ids.hpp>
#include <raywise/toplevel/area_id.hpp>
#include <raywise/trace/observer.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>

namespace raywise {

/// Told of every search before it starts: in the tree of an area, or in the global one (nothing),
/// on the closed interval [begin, end] of the ray; then of its steps, one by one in a binary tree
/// and summed elsewhere; then, once, whether the latest `hit` of the query came from the search
/// just made.
template <class O>
concept QueryObserver =
    TraceObserver<O> &&
    requires(O& seen, std::optional<AreaId> area, float t, const Counts& steps) {
        seen.search(area, t, t);
        seen.steps(steps);
        seen.found();
    };

/// Watches nothing, costs nothing.
struct SilentQuery : Silent {
    static constexpr void search(std::optional<AreaId>, float, float) {}
    static constexpr void steps(const Counts&) {}
    static constexpr void found() {}
};

/// Sums the steps of all searches, local and global, of any number of queries.
struct CountedQuery : Counts {
    constexpr void search(std::optional<AreaId> area, float, float) {
        ++(area ? local_searches : global_searches);
    }

    constexpr void steps(const Counts& counts) { Counts::operator+=(counts); }

    static constexpr void found() {}

    std::uint64_t local_searches = 0;
    std::uint64_t global_searches = 0;
};

/// One search of a query.
struct Search {
    std::optional<AreaId> area; ///< nothing: the global tree
    float begin = 0;            ///< of the searched interval, closed
    float end = 0;
    Counts counts; ///< steps of this search alone
};

/// The report of one query; start with a fresh one for each. No allocation.
class Served {
public:
    /// In the order made; none for an invalid ray.
    [[nodiscard]] std::span<const Search> searches() const { return {searches_.data(), count_}; }

    /// The search that found the hit that was returned; nothing on a miss.
    [[nodiscard]] const Search* answered() const {
        return answer_ < count_ ? &searches_[answer_] : nullptr;
    }

    /// Whether the global tree was searched.
    [[nodiscard]] bool went_global() const {
        return count_ > 0 && !searches_[count_ - 1].area.has_value();
    }

    /// Steps of all searches together.
    [[nodiscard]] Counts total() const {
        Counts sum;
        for (const Search& search : searches())
            sum += search.counts;
        return sum;
    }

    void search(std::optional<AreaId> area, float begin, float end) {
        searches_[count_++] = {area, begin, end, {}};
    }

    void steps(const Counts& counts) { latest() += counts; }

    /// The latest search found a better hit than those before.
    void found() { answer_ = count_ - 1; }

    void box_tests(std::size_t count) { latest().box_tests(count); }

    void inner(NodeId node) { latest().inner(node); }

    void leaf(NodeId node) { latest().leaf(node); }

    void prim(PrimId prim) { latest().prim(prim); }

private:
    Counts& latest() { return searches_[count_ - 1].counts; }

    static constexpr std::size_t none = ~std::size_t{0};

    std::array<Search, 16> searches_{}; ///< eight areas and the global tree at most
    std::size_t count_ = 0;
    std::size_t answer_ = none;
};

static_assert(QueryObserver<SilentQuery> && QueryObserver<CountedQuery> && QueryObserver<Served>);

} // namespace raywise
