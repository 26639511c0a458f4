#include <raywise/io/ray_file.hpp>

#include "byte_reader.hpp"
#include "npy.hpp"
#include "scene_reader.hpp"
#include "zip.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/distribution/measured.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/io/files.hpp>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raywise {

namespace {

using io_detail::append;
using io_detail::narrowed;
using io_detail::NpyArray;
using Members = std::map<std::string, std::string, std::less<>>;

[[noreturn]] void refuse(const std::filesystem::path& path, std::string_view reason) {
    throw Error(path.string(), nowhere(), reason);
}

const std::string&
member(const std::filesystem::path& path, const Members& members, std::string_view name) {
    const auto found = members.find(fmt::format("{}.npy", name));
    if (found == members.end()) refuse(path, fmt::format("it has no member '{}'", name));
    return found->second;
}

bool is_archive(const std::filesystem::path& path) {
    const std::string suffix = path.extension().string();
    if (suffix == ".npz") return true;
    if (suffix == ".npy") return false;
    refuse(path, "the suffix must be .npy or .npz");
}

std::vector<Ray> rays_of(const std::filesystem::path& path, const NpyArray& array) {
    if (array.is_flat() || array.kind() != 'f' || (array.columns() != 8 && array.columns() != 6))
        refuse(path, "rays must be floats of shape (N, 8) or (N, 6)");
    std::vector<Ray> rays(array.rows());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        Ray& ray = rays[i];
        for (int axis = 0; axis < 3; ++axis) {
            const auto column = static_cast<std::size_t>(axis);
            ray.origin[axis] = narrowed(array.number(i, column));
            ray.direction[axis] = narrowed(array.number(i, column + 3));
        }
        if (array.columns() == 8) {
            ray.t_min = narrowed(array.number(i, 6));
            ray.t_max = narrowed(array.number(i, 7));
        }
        if (!is_valid(ray))
            refuse(
                path,
                fmt::format(
                    "ray {} is not valid: it needs a finite origin, a finite direction that is not "
                    "zero, and 0 <= t_min <= t_max",
                    i
                )
            );
    }
    return rays;
}

std::string npy_of(std::span<const Ray> rays) {
    std::string bytes = io_detail::npy_header("<f4", fmt::format("({}, 8)", rays.size()));
    bytes.reserve(bytes.size() + 32 * rays.size());
    for (const Ray& ray : rays)
        for (const float value :
             {ray.origin.x,
              ray.origin.y,
              ray.origin.z,
              ray.direction.x,
              ray.direction.y,
              ray.direction.z,
              ray.t_min,
              ray.t_max})
            append(bytes, value);
    return bytes;
}

/// One column of numbers as an array of one dimension.
template <class T, class Items, class Get>
std::string npy_column(std::string_view type, const Items& items, const Get& get) {
    std::string bytes = io_detail::npy_header(type, fmt::format("({},)", items.size()));
    for (const auto& item : items)
        append(bytes, static_cast<T>(get(item)));
    return bytes;
}

} // namespace

std::vector<Ray> load_rays(const std::filesystem::path& path) {
    const bool has_members = is_archive(path);
    const std::string bytes = read_file(path);
    if (!has_members) return rays_of(path, NpyArray(path, bytes, 0));
    const Members members = io_detail::read_zip(path, bytes);
    return rays_of(path, NpyArray(path, member(path, members, "rays"), 0));
}

void save_rays(const std::filesystem::path& path, std::span<const Ray> rays) {
    write_file_atomically(path, npy_of(rays));
}

std::vector<RecordedRay> load_recorded_rays(const std::filesystem::path& path) {
    std::vector<RecordedRay> recorded;
    if (!is_archive(path)) {
        for (const Ray& ray : load_rays(path))
            recorded.push_back({ray, 1});
        return recorded;
    }
    const std::string bytes = read_file(path);
    const Members members = io_detail::read_zip(path, bytes);
    const std::vector<Ray> rays = rays_of(path, NpyArray(path, member(path, members, "rays"), 0));
    recorded.reserve(rays.size());
    for (const Ray& ray : rays)
        recorded.push_back({ray, 1});
    const auto weights = members.find("weights.npy");
    if (weights == members.end()) return recorded;
    const NpyArray array(path, weights->second, 0);
    if (!array.is_flat() || array.kind() != 'f' || array.rows() != rays.size())
        refuse(path, "weights must be floats of shape (N), one for each ray");
    for (std::size_t i = 0; i < recorded.size(); ++i) {
        recorded[i].weight = array.number(i, 0);
        if (!(recorded[i].weight >= 0 && std::isfinite(recorded[i].weight)))
            refuse(path, fmt::format("the weight of ray {} is not finite and >= 0", i));
    }
    return recorded;
}

void save_recorded_rays(const std::filesystem::path& path, std::span<const RecordedRay> rays) {
    std::vector<Ray> bare;
    bare.reserve(rays.size());
    for (const RecordedRay& recorded : rays)
        bare.push_back(recorded.ray);
    const std::array<std::pair<std::string, std::string>, 2> members{
        {{"rays.npy", npy_of(bare)},
         {"weights.npy",
          npy_column<double>("<f8", rays, [](const RecordedRay& ray) { return ray.weight; })}}
    };
    write_file_atomically(path, io_detail::write_zip(members));
}

void save_hits(const std::filesystem::path& path, std::span<const std::optional<Hit>> hits) {
    const auto of = [](const std::optional<Hit>& hit) { return hit.value_or(Hit{}); };
    using Item = std::optional<Hit>;
    const std::array<std::pair<std::string, std::string>, 5> members{
        {{"t.npy", npy_column<float>("<f4", hits, [&](const Item& h) { return of(h).t; })},
         {"prim.npy",
          npy_column<std::uint32_t>("<u4", hits, [&](const Item& h) { return of(h).prim; })},
         {"u.npy", npy_column<float>("<f4", hits, [&](const Item& h) { return of(h).u; })},
         {"v.npy", npy_column<float>("<f4", hits, [&](const Item& h) { return of(h).v; })},
         {"front.npy",
          npy_column<std::uint8_t>("|b1", hits, [&](const Item& h) { return of(h).front; })}}
    };
    write_file_atomically(path, io_detail::write_zip(members));
}

std::vector<std::optional<Hit>> load_hits(const std::filesystem::path& path) {
    const std::string bytes = read_file(path);
    const Members members = io_detail::read_zip(path, bytes);
    const auto column = [&](std::string_view name, char kind) {
        const NpyArray array(path, member(path, members, name), 0);
        if (!array.is_flat() || array.kind() != kind)
            refuse(path, fmt::format("member '{}' has another type or shape", name));
        return array;
    };
    const NpyArray t = column("t", 'f');
    const NpyArray prim = column("prim", 'u');
    const NpyArray u = column("u", 'f');
    const NpyArray v = column("v", 'f');
    const NpyArray front = column("front", 'b');
    for (const NpyArray* array : {&prim, &u, &v, &front})
        if (array->rows() != t.rows()) refuse(path, "the members differ in their lengths");
    std::vector<std::optional<Hit>> hits(t.rows());
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const PrimId id = to_prim(static_cast<std::size_t>(prim.number(i, 0)));
        const float distance = narrowed(t.number(i, 0));
        if ((id == no_prim) != std::isinf(distance) || !(distance >= 0))
            refuse(path, fmt::format("row {} is neither a hit nor a miss", i));
        if (id == no_prim) continue;
        hits[i] =
            Hit{distance,
                narrowed(u.number(i, 0)),
                narrowed(v.number(i, 0)),
                id,
                front.number(i, 0) != 0};
        if (!std::isfinite(hits[i]->u) || !std::isfinite(hits[i]->v))
            refuse(path, fmt::format("row {} has coordinates that are not finite", i));
    }
    return hits;
}

} // namespace raywise
