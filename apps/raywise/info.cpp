// raywise info: what is in a scene.
#include "scene_source.hpp"
#include "session.hpp"

#include <raywise/core/hash.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/io/report.hpp>
#include <raywise/scene/scene.hpp>

#include <memory>
#include <string>

namespace raywise::app {

namespace {

Report describe(const Scene& scene, const std::string& title) {
    Report report;
    report.title = "Scene";
    ReportTable& table = report.table;
    add_fact(table, "scene", title);
    add_count(table, "triangles", scene.triangles.size());
    add_count(table, "vertices", scene.vertices.size());
    add_count(table, "degenerate_triangles", count_degenerate(scene));
    add_count(table, "duplicate_triangles", count_duplicates(scene));
    add_count(table, "groups", scene.groups.size());
    add_count(table, "lights", scene.lights.size());
    add_count(table, "cameras", scene.cameras.size());
    const Aabb box = bounds(scene);
    add_fact(table, "lo_x", static_cast<double>(box.lo.x));
    add_fact(table, "lo_y", static_cast<double>(box.lo.y));
    add_fact(table, "lo_z", static_cast<double>(box.lo.z));
    add_fact(table, "hi_x", static_cast<double>(box.hi.x));
    add_fact(table, "hi_y", static_cast<double>(box.hi.y));
    add_fact(table, "hi_z", static_cast<double>(box.hi.z));
    add_fact(table, "content_hash", hex(content_hash(scene)));
    return report;
}

} // namespace

Command add_info(CLI::App& root, CommonOptions& options) {
    CLI::App* app =
        root.add_subcommand("info", "Say what is in a scene: counts, bounds, content hash");
    const auto source = std::make_shared<SceneOptions>();
    add_scene_options(*app, *source);
    add_common_options(*app, options, "Write the report to this file");
    return {app, {}, [source](const Session& session) {
                const Scene scene = open_scene(*source, session);
                Report report = describe(scene, scene_title(*source));
                report.provenance = session.provenance();
                report.provenance.scene = scene_title(*source);
                report.provenance.scene_hash = content_hash(scene);
                session.put_report(report, session.options.output);
            }};
}

} // namespace raywise::app
