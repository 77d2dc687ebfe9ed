#include "host/cli/help.h"

#include <algorithm>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "host/cli/checks.h"
#include "host/cli/quantity.h"

namespace impactdic::cli {
namespace {

constexpr std::size_t kFewOptions = 16;  // of which none is held back

struct Place {
  const char* group;
  bool daily;  // shown by --help
};

constexpr const char* kOthers = "Options";  // where an option stands that the list does not name
// In the order of the help.
constexpr const char* kGroups[] = {"Results",           kOthers,   "Clip",    "Scale and axes",
                                   "Ball and region",   "Windows", "Overlay", "Several processes",
                                   "Rows as they come", "This run"};

constexpr std::pair<const char*, Place> kPlaces[] = {
    {"output", {"Results", true}},
    {"force", {"Results", true}},
    {"resume", {"Results", true}},
    {"compress", {"Results", false}},
    {"no-field", {"Results", false}},
    {"no-checksum", {"Results", false}},
    {"frames", {"Clip", true}},
    {"fps", {"Clip", true}},
    {"raw", {"Clip", false}},
    {"channel", {"Clip", false}},
    {"gamma", {"Clip", false}},
    {"max-megapixels", {"Clip", false}},
    {"sandbox", {"Clip", false}},
    {"no-sandbox", {"Clip", false}},
    {"ball-diameter-mm", {"Scale and axes", true}},
    {"mm-per-px", {"Scale and axes", true}},
    {"surface-angle-deg", {"Scale and axes", true}},
    {"inertia-factor", {"Scale and axes", true}},
    {"camera", {"Scale and axes", false}},
    {"camera-motion", {"Scale and axes", false}},
    {"ball-diameter-sd-mm", {"Scale and axes", false}},
    {"mm-per-px-sd", {"Scale and axes", false}},
    {"surface-angle-sd-deg", {"Scale and axes", false}},
    {"gravity-angle-deg", {"Scale and axes", false}},
    {"drop-height-mm", {"Scale and axes", false}},
    {"distance-mm", {"Scale and axes", false}},
    {"distance-sd-mm", {"Scale and axes", false}},
    {"roi", {"Ball and region", true}},
    {"radius-px", {"Ball and region", true}},
    {"ball", {"Ball and region", true}},
    {"reference", {"Ball and region", true}},
    {"polygon", {"Ball and region", true}},
    {"mask", {"Ball and region", true}},
    {"ball-at", {"Ball and region", false}},
    {"estimator", {"Ball and region", false}},
    {"body", {"Ball and region", false}},
    {"motion", {"Ball and region", false}},
    {"window", {"Windows", true}},
    {"spacing", {"Windows", false}},
    {"search", {"Windows", false}},
    {"method", {"Windows", false}},
    {"interp", {"Windows", false}},
    {"spline-degree", {"Windows", false}},
    {"max-iterations", {"Windows", false}},
    {"min-correlation", {"Windows", false}},
    {"min-texture", {"Windows", false}},
    {"max-sd", {"Windows", false}},
    {"overlay", {"Overlay", true}},
    {"slow-motion", {"Overlay", false}},
    {"arrow-scale", {"Overlay", false}},
    {"share", {"Several processes", false}},
    {"shard", {"Several processes", false}},
    {"join", {"Several processes", false}},
    {"lost-after", {"Several processes", false}},
    {"live", {"Rows as they come", false}},
    {"look", {"Rows as they come", false}},
    {"wait", {"Rows as they come", false}},
    {"lag", {"Rows as they come", false}},
    {"job", {"This run", true}},
    {"quiet", {"This run", true}},
    {"device", {"This run", false}},
    {"threads", {"This run", false}},
    {"verbose", {"This run", false}},
    {"help", {"This run", true}},
    {"help-all", {"This run", true}},
};

const Place* place_of(const CLI::Option& option) {
  for (const auto& [name, place] : kPlaces) {
    for (const std::string& own : option.get_lnames()) {
      if (own == name) return &place;
    }
  }
  return nullptr;
}

// Whose help is short: it has a command's name and many options.
bool is_long_list(const CLI::App& app) {
  return app.get_parent() != nullptr && app.get_options([](const CLI::Option* o) {
                                             return o->nonpositional();
                                           }).size() > kFewOptions;
}

class GroupedHelp : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::Sub) return CLI::Formatter::make_help(app, name, mode);
    const bool all = mode == CLI::AppFormatMode::All || !is_long_list(*app);
    std::ostringstream out;
    out << make_description(app) << make_usage(app, name) << make_positionals(app);
    std::size_t held_back = 0;
    for (const char* group : kGroups) out << options_of(*app, group, all, held_back);
    if (app->get_parent() == nullptr) out << make_subcommands(app, CLI::AppFormatMode::Normal);
    if (held_back > 0) {
      out << "\n" << held_back << " more: impactdic " << app->get_name() << " --help-all\n";
    }
    out << '\n' << make_footer(app);
    return out.str();
  }

 private:
  std::string options_of(const CLI::App& app, const std::string& group, bool all,
                         std::size_t& held_back) const {
    std::vector<const CLI::Option*> shown;
    for (const CLI::Option* option : app.get_options()) {
      if (!option->nonpositional() || option->get_group() != group) continue;
      const Place* place = place_of(*option);
      if (all || place == nullptr || place->daily) {
        shown.push_back(option);
      } else {
        ++held_back;
      }
    }
    return shown.empty() ? "" : make_group(group, false, shown);
  }
};

// One list where groups would have an option or two each.
void group_options(CLI::App& command) {
  if (!is_long_list(command)) return;
  for (CLI::Option* option : command.get_options()) {
    const Place* place = place_of(*option);
    if (place != nullptr && option->nonpositional()) option->group(place->group);
  }
}

}  // namespace

void show_help_in_groups(CLI::App& app) {
  app.formatter(std::make_shared<GroupedHelp>());
  app.set_help_flag("-h,--help", "Show what is needed every day, and exit");
  app.set_help_all_flag("--help-all", "Show every option, and exit");
}

void arrange(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    group_options(*command);
    refuse_non_numbers(*command);
    take_units(*command);
  }
}

}  // namespace impactdic::cli
