#include <raywise/bvh/validate.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raywise {

namespace {

constexpr std::uint8_t unreached = 0xFF;

bool is_sound(const Aabb& box) {
    return is_finite(box.lo) && is_finite(box.hi) && !box.is_empty();
}

std::string at_node(std::size_t id, const char* reason) {
    return "node " + std::to_string(id) + " " + reason;
}

/// Checks one tree. Parents stand before their children, so one pass in array order both spreads
/// the levels and meets every node after its parent: a cycle would need a child before its parent.
class Inspection {
public:
    Inspection(const Bvh& tree, std::size_t prim_count, std::span<const Aabb> boxes)
        : tree_(tree)
        , prim_count_(prim_count)
        , boxes_(boxes)
        , levels_(tree.nodes.size(), unreached)
        , is_covered_(tree.prims.size(), false) {}

    std::optional<std::string> run() {
        if (tree_.is_empty()) {
            if (tree_.prims.empty()) return std::nullopt;
            return "a tree without nodes has primitives";
        }
        levels_[0] = 0;
        for (std::size_t id = 0; id < tree_.nodes.size(); ++id)
            if (const char* reason = inspect(id)) return at_node(id, reason);
        if (covered_ != tree_.prims.size()) return "a primitive slot belongs to no leaf";
        return std::nullopt;
    }

private:
    const char* inspect(std::size_t id) {
        if (levels_[id] == unreached) return "is not reached from the root";
        const Node& node = tree_.nodes[id];
        if (!is_sound(node.box())) return "has an empty box or one that is not finite";
        return node.is_leaf() ? inspect_leaf(node) : inspect_inner(id, node);
    }

    const char* inspect_inner(std::size_t id, const Node& node) {
        // Not right(): left + 1 may wrap around.
        const std::size_t left = to_index(node.left());
        if (left <= id) return "has a child that stands before it";
        if (left >= tree_.nodes.size() || left + 1 >= tree_.nodes.size())
            return "has a child outside the tree";
        if (levels_[id] >= Bvh::max_depth) return "has children deeper than a tree may be";
        for (const std::size_t child : {left, left + 1}) {
            if (levels_[child] != unreached) return "shares a child with another node";
            if (!contains(node.box(), tree_.nodes[child].box()))
                return "does not enclose its children";
            levels_[child] = static_cast<std::uint8_t>(levels_[id] + 1);
        }
        return nullptr;
    }

    const char* inspect_leaf(const Node& node) {
        const std::size_t slots = tree_.prims.size();
        if (node.first() > slots || node.count() > slots - node.first())
            return "has a primitive slot outside the tree";
        for (std::size_t slot = node.first(); slot < node.first() + node.count(); ++slot) {
            if (is_covered_[slot]) return "shares a primitive slot with another leaf";
            is_covered_[slot] = true;
            const std::size_t prim = to_index(tree_.prims[slot]);
            if (prim >= prim_count_) return "holds a primitive that does not exist";
            if (boxes_.empty()) continue;
            if (!is_sound(boxes_[prim])) return "holds a primitive without a finite box";
            if (!contains(node.box(), boxes_[prim])) return "does not enclose its primitives";
        }
        covered_ += node.count();
        return nullptr;
    }

    const Bvh& tree_;
    std::size_t prim_count_;
    std::span<const Aabb> boxes_; ///< empty: not to be compared
    std::vector<std::uint8_t> levels_;
    std::vector<bool> is_covered_;
    std::size_t covered_ = 0;
};

void throw_fault(const std::optional<std::string>& fault) {
    if (fault) throw Error("not a valid tree: " + *fault);
}

} // namespace

std::optional<std::string> find_fault(const Bvh& tree, std::size_t prim_count) {
    return Inspection(tree, prim_count, {}).run();
}

std::optional<std::string> find_fault(const Bvh& tree, std::span<const Aabb> boxes) {
    return Inspection(tree, boxes.size(), boxes).run();
}

void validate(const Bvh& tree, std::size_t prim_count) {
    throw_fault(find_fault(tree, prim_count));
}

void validate(const Bvh& tree, std::span<const Aabb> boxes) {
    throw_fault(find_fault(tree, boxes));
}

} // namespace raywise
