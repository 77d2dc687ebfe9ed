// Settings of a request by name, as keyword arguments of Python: those of the command line, with
// underscores in place of dashes.
#pragma once

#include <impactdic/correlate.h>
#include <impactdic/error.h>
#include <impactdic/track.h>
#include <nanobind/nanobind.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "host/run/settings/settings.h"

namespace impactdic::python {

// Takes `value` over. Throws InvalidArgument, naming `where`, for another type than wanted.
void assign(nanobind::handle value, bool& to, const std::string& where);
void assign(nanobind::handle value, int& to, const std::string& where);
void assign(nanobind::handle value, std::uint64_t& to, const std::string& where);
void assign(nanobind::handle value, double& to, const std::string& where);
void assign(nanobind::handle value, std::string& to, const std::string& where);
void assign(nanobind::handle value, std::vector<std::string>& to, const std::string& where);
void assign(nanobind::handle value, FieldMethod& to, const std::string& where);
void assign(nanobind::handle value, Estimator& to, const std::string& where);
void assign(nanobind::handle value, Body& to, const std::string& where);
void assign(nanobind::handle value, Channel& to, const std::string& where);
void assign(nanobind::handle value, CameraMotionUse& to, const std::string& where);
void assign(nanobind::handle value, ReferenceFrame& to, const std::string& where);
void assign(nanobind::handle value, RegionMotion& to, const std::string& where);
// (first, end, step)
void assign(nanobind::handle value, FrameRange& to, const std::string& where);
// (x, y, width, height)
void assign(nanobind::handle value, std::optional<Roi>& to, const std::string& where);
// (low, high)
void assign(nanobind::handle value, std::optional<RadiusRange>& to, const std::string& where);
// (width, height, bits)
void assign(nanobind::handle value, std::optional<RawLayout>& to, const std::string& where);
// [(x, y), ...]
void assign(nanobind::handle value, std::vector<PointPx>& to, const std::string& where);
void assign(nanobind::handle value, std::vector<BallByHand>& to, const std::string& where);
void assign(nanobind::handle value, std::optional<double>& to, const std::string& where);
// A setting of a kind that has no words in Python yet.
template <typename T>
void assign(nanobind::handle, T&, const std::string& where) {
  throw InvalidArgument("cannot be set from Python", where, "use the command line");
}

// As many numbers as `count`. Throws InvalidArgument.
std::vector<double> numbers(nanobind::handle value, std::size_t count, const std::string& where);

// Visits the settings of a request (host/run/settings/settings.h) and takes over those that stand
// in a dictionary.
class OptionReader {
 public:
  explicit OptionReader(const nanobind::dict& values);
  template <typename T>
  void operator()(const run::Setting& setting, T& member) {
    (*this)(setting.key, member);
    if constexpr (std::is_same_v<T, bool>) {
      if (met_ && (setting.kind & run::kNegated)) member = !member;
    }
  }
  template <typename T>
  void operator()(std::string key, T& member) {
    std::replace(key.begin(), key.end(), '-', '_');
    known_.insert(key);
    const auto found = values_.find(key);
    met_ = found != values_.end() && !found->second.is_none();
    if (met_) assign(found->second, member, key);
  }
  // A name that somebody else reads.
  void pass_over(const std::string& key) { known_.insert(key); }
  // Throws InvalidArgument for a name that no setting has.
  void finish(const std::string& job) const;

 private:
  std::map<std::string, nanobind::object> values_;
  std::set<std::string> known_;
  bool met_ = false;
};

}  // namespace impactdic::python
