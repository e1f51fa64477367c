#include "vdb/commands.h"
#include "vdb/field.h"
#include "vdb/output.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanovdb/util/OpenToNanoVDB.h>

namespace abbe::vdb {

namespace {

using Kind = VdbFault::Kind;

template <typename GridType> void send(const Field<GridType>& field, const openvdb::GridBase& source, bool vector) {
    using Value = typename GridType::ValueType;
    nanovdb::OpenToNanoVDB<Value, typename nanovdb::OpenToNanoType<Value>::Type> convert;
    convert.setStats(nanovdb::StatsMode::MinMax);
    convert.setChecksum(nanovdb::ChecksumMode::Disable);
    const auto handle = convert(*field.grid);
    VdbGridHead head;
    head.facts = {source.getName(), unitOf(source), volumeClassOf(source), *affineTransform(source)};
    head.vector = vector;
    head.notes = field.notes;
    head.bytes = handle.size();
    writeFrame(VdbFrame::grid, head);
    writeBytes(handle.data(), handle.size());
}

void checkTransform(const VdbInput& input, const openvdb::GridBase& grid) {
    const std::string subject = input.subject(grid.getName());
    if (!grid.transform().isLinear())
        throw Failure(Kind::transform,
                      subject + " lies in a frustum; only affine transforms can be rendered (resample it)");
    if (!affineTransform(grid)) throw Failure(Kind::transform, subject + " has a transform without an inverse");
}

void readOne(VdbInput& input, const std::string& name, const std::string& use) {
    const bool optional = use.ends_with('?');
    const auto kind = static_cast<VdbUse>(use[0] - '0');
    const auto grid = input.grid(name);
    if (!grid && optional) {
        writeFrame(VdbFrame::noGrid);
        return;
    }
    if (!grid) {
        const auto names = input.names();
        const std::string known = names.empty() ? "it has none" : fmt::format("it has `{}`", fmt::join(names, "`, `"));
        throw Failure(Kind::noGrid, fmt::format("`{}` has no grid `{}`; {}", input.path(), name, known), names);
    }
    checkTransform(input, *grid);
    if (kind == VdbUse::vector)
        send(vectorField(input, grid), *grid, true);
    else
        send(amountField(input, grid, kind), *grid, false);
}

} // namespace

void read(Arguments arguments) {
    VdbInput input(arguments[0]);
    for (std::size_t i = 1; i + 1 < arguments.size(); i += 2) readOne(input, arguments[i], arguments[i + 1]);
}

} // namespace abbe::vdb
