#include "bench/chart.hpp"
#include "bench/goals.hpp"
#include "bench/rows.hpp"

#include <raywise/analysis/ray_class.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raywise::app {

namespace {

// All lengths in pixels.
constexpr double margin = 24;
constexpr double scene_width = 130;
constexpr double class_width = 96;
constexpr double panel_width = 400;
constexpr double panel_gap = 44;
constexpr double bar_height = 11;
constexpr double bar_step = 14;
constexpr double group_gap = 14;
constexpr double head_height = 92;
constexpr double foot_height = 58;

constexpr const char* ink = "#22272e";
constexpr const char* faint = "#d7dbe0";
constexpr const char* muted = "#6b7480";

constexpr std::array peers = {Peer::single, Peer::best};

const char* color_of(RayKind kind) {
    switch (kind) {
    case RayKind::exact:
        return "#2f6db3";
    case RayKind::near_affine:
        return "#d98a29";
    case RayKind::general:
        break;
    }
    return "#5f8f52";
}

std::string label_of(RayKind kind) {
    switch (kind) {
    case RayKind::exact:
        return "exact rays";
    case RayKind::near_affine:
        return "near-affine rays";
    case RayKind::general:
        break;
    }
    return "other rays";
}

std::string escaped_for_xml(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
        case '<':
            result += "&lt;";
            break;
        case '>':
            result += "&gt;";
            break;
        case '&':
            result += "&amp;";
            break;
        default: // XML knows no control characters
            result += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
        }
    }
    return result;
}

/// The image as it grows.
class Svg {
public:
    void rectangle(double x, double y, double width, double height, const char* color) {
        body_ += fmt::format(
            R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"/>)"
            "\n",
            x,
            y,
            width,
            height,
            color
        );
    }

    void upright_line(double x, double top, double bottom, const char* color, double width) {
        body_ += fmt::format(
            R"(<line x1="{0:.1f}" y1="{1:.1f}" x2="{0:.1f}" y2="{2:.1f}" stroke="{3}" stroke-width="{4}"/>)"
            "\n",
            x,
            top,
            bottom,
            color,
            width
        );
    }

    struct Type {
        double size = 11;
        const char* anchor = "start";
        const char* color = ink;
        bool is_bold = false;
    };

    void text(double x, double y, const std::string& words, const Type& type) {
        body_ += fmt::format(
            R"(<text x="{:.1f}" y="{:.1f}" font-size="{}" text-anchor="{}" fill="{}"{}>{}</text>)"
            "\n",
            x,
            y,
            type.size,
            type.anchor,
            type.color,
            type.is_bold ? R"( font-weight="600")" : "",
            escaped_for_xml(words)
        );
    }

    [[nodiscard]] std::string finish(double width, double height) const {
        return fmt::format(
                   R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0:.0f}" height="{1:.0f}" viewBox="0 0 {0:.0f} {1:.0f}" font-family="Helvetica, Arial, sans-serif">)"
                   "\n"
                   R"(<rect width="100%" height="100%" fill="#ffffff"/>)"
                   "\n",
                   width,
                   height
               ) +
               body_ + "</svg>\n";
    }

private:
    std::string body_;
};

/// Ratios to pixels, by powers of two.
class Scale {
public:
    explicit Scale(std::span<const BenchRow* const> rows) {
        for (const BenchRow* row : rows) {
            low_ = std::min(low_, std::floor(std::log2(row->ratio)));
            high_ = std::max(high_, std::ceil(std::log2(row->ratio)));
        }
        low_ = std::max(low_, -10.0);
        high_ = std::min(high_, 10.0);
    }

    [[nodiscard]] double operator()(double ratio) const {
        const double at = std::clamp(std::log2(ratio), low_, high_);
        return (at - low_) / (high_ - low_) * panel_width;
    }

    [[nodiscard]] int low() const { return static_cast<int>(low_); }

    [[nodiscard]] int high() const { return static_cast<int>(high_); }

private:
    double low_ = -1; // 1/2x
    double high_ = 3; // 8x
};

std::string ratio_label(double ratio) {
    return ratio < 0.995 ? fmt::format("{:.2f}", ratio) : fmt::format("{:.1f}", ratio);
}

/// The bars of one scene, from top to bottom: one line for each class.
struct Group {
    std::string scene;
    std::vector<RayClass> classes;
};

class Chart {
public:
    explicit Chart(std::span<const BenchRow> rows) {
        for (const BenchRow& row : rows)
            if (row.rounds > 0 && row.ratio > 0) rows_.push_back(&row);
        for (const BenchRow* row : rows_) {
            if (groups_.empty() || groups_.back().scene != row->scene)
                groups_.push_back({row->scene, {}});
            std::vector<RayClass>& classes = groups_.back().classes;
            if (std::find(classes.begin(), classes.end(), row->rays) == classes.end())
                classes.push_back(row->rays);
        }
    }

    std::string draw(const std::string& caption) {
        const Scale scale(rows_);
        const double bottom = head_height + height_of_groups();
        draw_heading();
        for (std::size_t p = 0; p < peers.size(); ++p)
            draw_panel(peers[p], scale, left_of(p), bottom);
        draw_labels();
        svg_.text(margin, bottom + foot_height - 16, caption, {.size = 10, .color = muted});
        return svg_.finish(left_of(peers.size()) - panel_gap + margin + 26, bottom + foot_height);
    }

private:
    static double left_of(std::size_t panel) {
        return margin + scene_width + class_width + 10 +
               static_cast<double>(panel) * (panel_width + panel_gap);
    }

    [[nodiscard]] double height_of_groups() const {
        double height = 0;
        for (const Group& group : groups_)
            height += group_gap + bar_step * static_cast<double>(group.classes.size());
        return height;
    }

    /// Calls `visit(group, class, top)` for every line of bars.
    template <class Visitor>
    void for_each_line(const Visitor& visit) const {
        double top = head_height;
        for (const Group& group : groups_) {
            for (const RayClass rays : group.classes) {
                visit(group, rays, top);
                top += bar_step;
            }
            top += group_gap;
        }
    }

    void draw_heading() {
        svg_.text(margin, 30, "Rays per second beside Embree", {.size = 18, .is_bold = true});
        double x = margin;
        for (const RayKind kind : {RayKind::exact, RayKind::near_affine, RayKind::general}) {
            svg_.rectangle(x, 43, 11, 11, color_of(kind));
            svg_.text(x + 16, 52.5, label_of(kind), {.color = muted});
            x += 34 + 6 * static_cast<double>(label_of(kind).size());
        }
        svg_.rectangle(x + 4, 42, 2.5, 13, ink);
        svg_.text(x + 16, 52.5, "goal (geometric mean over the scenes)", {.color = muted});
    }

    void draw_panel(Peer peer, const Scale& scale, double left, double bottom) {
        svg_.text(
            left,
            head_height - 20,
            peer == Peer::single ? "one ray per call, ours / Embree HIGH"
                                 : "batches, ours / the fastest of Embree's calls",
            {.size = 12, .is_bold = true}
        );
        for (int power = scale.low(); power <= scale.high(); ++power) {
            const double ratio = std::exp2(power);
            const double x = left + scale(ratio);
            if (power != 0) svg_.upright_line(x, head_height - 6, bottom, faint, 1);
            svg_.text(
                x,
                bottom + 12,
                power < 0 ? fmt::format("1/{:g}", 1 / ratio) : fmt::format("{:g}x", ratio),
                {.size = 10, .anchor = "middle", .color = muted}
            );
        }
        for_each_line([&](const Group& group, RayClass rays, double top) {
            if (const BenchRow* row = find(group.scene, rays, peer))
                draw_bar(*row, scale, left, top);
        });
        const double one = left + scale(1);
        svg_.upright_line(one, head_height - 8, bottom + 1, ink, 1.2);
    }

    void draw_bar(const BenchRow& row, const Scale& scale, double left, double top) {
        const double one = left + scale(1);
        const double end = left + scale(row.ratio);
        const RayKind kind = kind_of(row.rays);
        svg_.rectangle(
            std::min(one, end), top, std::max(1.0, std::abs(end - one)), bar_height, color_of(kind)
        );
        double mark = end;
        if (const std::optional<Goal> goal = goal_of(kind, row.peer)) {
            mark = left + scale(goal->mean);
            svg_.rectangle(mark - 1.25, top - 1, 2.5, bar_height + 2, ink);
        }
        // Beside the bar, out of the goal's way.
        double x = std::max(end, one) + 4;
        if (mark > x - 4 && mark < x + 24) x = mark + 5;
        svg_.text(x, top + bar_height - 2, ratio_label(row.ratio), {.size = 10});
    }

    void draw_labels() {
        std::string latest;
        for_each_line([&](const Group& group, RayClass rays, double top) {
            if (group.scene != latest)
                svg_.text(
                    margin, top + bar_height - 1.5, group.scene, {.size = 12, .is_bold = true}
                );
            latest = group.scene;
            svg_.text(
                left_of(0) - 10,
                top + bar_height - 2,
                std::string(name_of(rays)),
                {.size = 10, .anchor = "end", .color = muted}
            );
        });
    }

    [[nodiscard]] const BenchRow* find(const std::string& scene, RayClass rays, Peer peer) const {
        for (const BenchRow* row : rows_)
            if (row->scene == scene && row->rays == rays && row->peer == peer) return row;
        return nullptr;
    }

    std::vector<const BenchRow*> rows_;
    std::vector<Group> groups_;
    Svg svg_;
};

} // namespace

std::string draw_chart(std::span<const BenchRow> rows, const std::string& caption) {
    return Chart(rows).draw(caption);
}

} // namespace raywise::app
