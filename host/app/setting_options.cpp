#include "host/app/setting_options.h"

#include "host/app/command.h"
#include "host/run/settings/setting_texts.h"

namespace impactdic::app {
namespace {

// Of values that are wrong whatever the run is.
std::map<std::string, CLI::Validator> checks() {
  return {
      {"ball-diameter-mm", positive_number()},
      {"ball-diameter-sd-mm", positive_number()},
      {"mm-per-px", positive_number()},
      {"mm-per-px-sd", positive_number()},
      {"surface-angle-sd-deg", positive_number()},
      {"drop-height-mm", positive_number()},
      {"inertia-factor", CLI::Range(0.01, 1.0)},
      {"distance-mm", positive_number()},
      {"distance-sd-mm", positive_number()},
      {"slow-motion", non_negative_number()},
      {"arrow-scale", non_negative_number()},
      {"compress", CLI::Range(0, 9)},
      {"fps", positive_number()},
      {"gamma", CLI::Range(0.2, 5.0)},
      {"max-megapixels", positive_number()},
  };
}

}  // namespace

const OptionHelps& setting_helps() {
  static const OptionHelps all = [] {
    OptionHelps helps;
    for (const auto& [key, text] : run::setting_texts()) helps[key].text = text;
    for (const auto& [key, check] : checks()) helps.at(key).check = check;
    return helps;
  }();
  return all;
}

}  // namespace impactdic::app
