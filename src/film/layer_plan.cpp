#include "film/layer_plan.h"

#include "base/diagnostic.h"
#include "schema/scene_tree.h"
#include "schema/suggest.h"
#include "schema/type.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

int SpectralBins::count() const { return static_cast<int>(std::lround((last - first) / width)); }

bool LayerPlan::empty() const {
    return offsets().total == 0 && !samples && !seconds && !invalid && !halves && !deep && !coversObjects() &&
           !coversMaterials();
}

LayerPlan::Offsets LayerPlan::offsets() const {
    Offsets o;
    const auto take = [&](bool wanted, int count) {
        const int at = o.total;
        if (wanted) o.total += count;
        return at;
    };
    o.surface = take(position || depth || uv, 1);
    o.position = take(position, 3);
    o.depth = take(depth, 1);
    o.uv = take(uv, 2);
    o.followed = take(motion, 1);
    o.motion = take(motion, 2);
    o.looks = take(normal, 1);
    o.normal = take(normal, 3);
    o.albedo = take(albedo, 3);
    o.groups = take(groupCount() > 0, 3 * groupCount());
    o.components = take(components, 9);
    o.spectral = take(spectral.has_value(), spectral ? spectral->count() : 0);
    return o;
}

namespace {

using schema::TableCell, schema::TableRow;

struct Flag {
    std::string_view word;
    void (*set)(LayerPlan&);
};

constexpr Flag kFlags[] = {
    {"albedo", [](LayerPlan& p) { p.albedo = true; }},
    {"normal", [](LayerPlan& p) { p.normal = true; }},
    {"position", [](LayerPlan& p) { p.position = true; }},
    {"depth", [](LayerPlan& p) { p.depth = true; }},
    {"uv", [](LayerPlan& p) { p.uv = true; }},
    {"motion", [](LayerPlan& p) { p.motion = true; }},
    {"samples", [](LayerPlan& p) { p.samples = true; }},
    {"seconds", [](LayerPlan& p) { p.seconds = true; }},
    {"invalid", [](LayerPlan& p) { p.invalid = true; }},
    {"components", [](LayerPlan& p) { p.components = true; }},
    {"object-id", [](LayerPlan& p) { p.objectIds = true; }},
    {"material-id", [](LayerPlan& p) { p.materialIds = true; }},
    {"denoise", [](LayerPlan& p) { p.halves = p.albedo = p.normal = p.depth = true; }},
};
constexpr std::string_view kOther[] = {"cryptomatte", "deep", "light-group", "spectral"};

class RowReader {
  public:
    RowReader(LayerPlan& plan, Diagnostics& diagnostics) : plan_(plan), diagnostics_(diagnostics) {}

    void read(const TableRow& row) {
        const TableCell& first = row.cells.front();
        if (first.number) return fault(first.span, "a layer is named by a word", "this is a number");
        const auto flag = std::ranges::find(kFlags, first.text, &Flag::word);
        if (flag != std::end(kFlags)) {
            if (row.cells.size() > 1)
                return fault(row.cells[1].span, fmt::format("the layer `{}` takes nothing more", first.text), "");
            flag->set(plan_);
        } else if (first.text == "cryptomatte") {
            readMattes(row);
        } else if (first.text == "light-group") {
            readGroup(row);
        } else if (first.text == "spectral") {
            readBins(row);
        } else if (first.text == "deep") {
            readDeep(row);
        } else {
            unknown(first);
        }
    }

  private:
    void fault(Span span, std::string message, std::string label, std::string help = {}) {
        diagnostics_.error("E0655", span, std::move(message), std::move(label)).help = std::move(help);
    }

    void unknown(const TableCell& cell) {
        std::vector<std::string_view> words(std::begin(kOther), std::end(kOther));
        for (const Flag& flag : kFlags) words.push_back(flag.word);
        std::ranges::sort(words);
        const std::string_view near = schema::nearest(cell.text, words);
        fault(cell.span, fmt::format("there is no layer `{}`", cell.text), "",
              near.empty() ? fmt::format("layers are {}", fmt::join(words, ", ")) : schema::didYouMean(near));
    }

    void readMattes(const TableRow& row) {
        if (row.cells.size() == 1) plan_.objects = plan_.materials = true;
        for (std::size_t i = 1; i < row.cells.size(); ++i) {
            const TableCell& cell = row.cells[i];
            if (cell.text == "objects")
                plan_.objects = true;
            else if (cell.text == "materials")
                plan_.materials = true;
            else
                fault(cell.span, "a Cryptomatte is of `objects` or `materials`", "");
        }
    }

    // A group is named for its only member if it has no others.
    void readGroup(const TableRow& row) {
        const auto isWord = [](const TableCell& c) { return !c.number && !c.text.empty(); };
        if (row.cells.size() < 2 || !std::ranges::all_of(row.cells, isWord))
            return fault(row.span, "a light group is a name and the names of its lights", "",
                         "for example `light-group warm lamp candle`; `light-group lamp` is a group of one");
        LightGroup group{row.cells[1].text, {}};
        const bool taken = group.name == "rest" ||
                           std::ranges::find(plan_.groups, group.name, &LightGroup::name) != plan_.groups.end();
        if (taken) return fault(row.cells[1].span, fmt::format("there is a light group `{}` already", group.name), "");
        for (std::size_t i = row.cells.size() == 2 ? 1 : 2; i < row.cells.size(); ++i) {
            const std::string& member = row.cells[i].text;
            for (const LightGroup& other : plan_.groups)
                if (std::ranges::find(other.members, member) != other.members.end())
                    return fault(row.cells[i].span, fmt::format("`{}` is in the light group `{}`", member, other.name),
                                 "a light is in one group", "their sum is the picture");
            group.members.push_back(member);
        }
        plan_.groups.push_back(std::move(group));
    }

    void readDeep(const TableRow& row) {
        constexpr double kLeast = 2, kMost = 4096;
        plan_.deep = 32;
        if (row.cells.size() == 1) return;
        const auto most = row.cells[1].number.value_or(0);
        if (row.cells.size() > 2 || !(most >= kLeast && most <= kMost) || most != std::floor(most))
            return fault(row.cells[1].span,
                         fmt::format("a deep layer takes the most samples of a pixel, {} to {}", kLeast, kMost),
                         "of surfaces, and as many of media",
                         "for example `deep 32`, which is what `deep` alone means");
        plan_.deep = static_cast<int>(most);
    }

    void readBins(const TableRow& row) {
        SpectralBins bins;
        std::vector<double> numbers;
        for (std::size_t i = 1; i < row.cells.size(); ++i)
            if (row.cells[i].number) numbers.push_back(*row.cells[i].number);
        if (numbers.size() + 1 != row.cells.size() || (numbers.size() != 0 && numbers.size() != 3))
            return fault(row.span, "spectral layers take the first and the last wavelength and the width of a bin", "",
                         "in nanometres: spectral 380 780 10");
        if (numbers.size() == 3) bins = {numbers[0], numbers[1], numbers[2]};
        const double count = (bins.last - bins.first) / bins.width;
        if (!(bins.first >= 360 && bins.last <= 830 && bins.width > 0 && bins.last > bins.first))
            return fault(row.span, "wavelengths are 360 to 830 nm, from the lower to the higher one", "",
                         "no light is simulated outside of them");
        if (std::abs(count - std::round(count)) > 1e-6 || count > 470)
            return fault(row.span,
                         fmt::format("a range of {:g} nm is no whole number of bins of {:g} nm, 470 at most",
                                     bins.last - bins.first, bins.width),
                         "");
        plan_.spectral = bins;
    }

    LayerPlan& plan_;
    Diagnostics& diagnostics_;
};

} // namespace

LayerPlan layerPlan(const schema::TableRows& rows, Diagnostics& diagnostics) {
    LayerPlan plan;
    RowReader reader(plan, diagnostics);
    for (const TableRow& row : rows.rows)
        if (!row.cells.empty()) reader.read(row);
    return plan;
}

} // namespace abbe
