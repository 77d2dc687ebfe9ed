#include "host/python/options.h"

#include <cmath>
#include <limits>

namespace nb = nanobind;

namespace impactdic::python {
namespace {

[[noreturn]] void refuse(nb::handle value, const std::string& where, const std::string& wanted) {
  throw InvalidArgument("must be " + wanted + ", not " + nb::repr(value).c_str(), where);
}

// A number of Python or numpy.
double number(nb::handle value, const std::string& where, const std::string& wanted) {
  if (nb::isinstance<nb::bool_>(value) || !PyNumber_Check(value.ptr()) ||
      nb::isinstance<nb::str>(value)) {
    refuse(value, where, wanted);
  }
  const double result = PyFloat_AsDouble(value.ptr());
  if (result == -1 && PyErr_Occurred()) {
    PyErr_Clear();
    refuse(value, where, wanted);
  }
  return result;
}

template <typename T>
T whole(nb::handle value, const std::string& where) {
  const double real = number(value, where, "a whole number");
  if (!(real == std::floor(real)) || real < static_cast<double>(std::numeric_limits<T>::min()) ||
      real > 9007199254740992.0 || real > static_cast<double>(std::numeric_limits<T>::max())) {
    refuse(value, where, "a whole number");
  }
  return static_cast<T>(real);
}

std::vector<nb::object> items(nb::handle value, const std::string& where,
                              const std::string& wanted) {
  const bool text = nb::isinstance<nb::str>(value);
  if (text || !(PySequence_Check(value.ptr()) || nb::hasattr(value, "__iter__"))) {
    refuse(value, where, wanted);
  }
  std::vector<nb::object> found;
  for (const nb::handle item : nb::iter(value)) found.push_back(nb::borrow(item));
  return found;
}

std::string text_of(nb::handle value, const std::string& where) {
  if (nb::isinstance<nb::str>(value)) return nb::cast<nb::str>(value).c_str();
  if (nb::hasattr(value, "__fspath__")) {
    const nb::object path = value.attr("__fspath__")();
    if (nb::isinstance<nb::str>(path)) return nb::cast<nb::str>(path).c_str();
  }
  refuse(value, where, "a text");
}

}  // namespace

std::vector<double> numbers(nb::handle value, std::size_t count, const std::string& where) {
  const std::string wanted = std::to_string(count) + " finite numbers";
  std::vector<double> found;
  for (const nb::object& item : items(value, where, wanted)) {
    found.push_back(number(item, where, wanted));
  }
  const bool finite =
      std::all_of(found.begin(), found.end(), [](double one) { return std::isfinite(one); });
  if (found.size() != count || !finite) refuse(value, where, wanted);
  return found;
}

void assign(nb::handle value, bool& to, const std::string& where) {
  const nb::str kind(value.type().attr("__name__"));  // bool, and numpy's bool_
  if (std::string(kind.c_str()).find("bool") == std::string::npos)
    refuse(value, where, "True or False");
  to = PyObject_IsTrue(value.ptr()) == 1;
}
void assign(nb::handle value, int& to, const std::string& where) { to = whole<int>(value, where); }
void assign(nb::handle value, std::uint64_t& to, const std::string& where) {
  to = whole<std::uint64_t>(value, where);
}
void assign(nb::handle value, double& to, const std::string& where) {
  to = number(value, where, "a number");
}
void assign(nb::handle value, std::optional<double>& to, const std::string& where) {
  to = number(value, where, "a number");
}
void assign(nb::handle value, std::string& to, const std::string& where) {
  to = text_of(value, where);
}
void assign(nb::handle value, std::vector<std::string>& to, const std::string& where) {
  to.clear();
  for (const nb::object& item : items(value, where, "a list of texts")) {
    to.push_back(text_of(item, where));
  }
}
void assign(nb::handle value, FieldMethod& to, const std::string& where) {
  to = parse_field_method(text_of(value, where));
}
void assign(nb::handle value, Estimator& to, const std::string& where) {
  to = parse_estimator(text_of(value, where));
}
void assign(nb::handle value, Body& to, const std::string& where) {
  to = parse_body(text_of(value, where));
}
void assign(nb::handle value, Channel& to, const std::string& where) {
  to = parse_channel(text_of(value, where));
}
void assign(nb::handle value, CameraMotionUse& to, const std::string& where) {
  to = parse_camera_motion(text_of(value, where));
}
void assign(nb::handle value, ReferenceFrame& to, const std::string& where) {
  to = parse_reference(text_of(value, where));
}
void assign(nb::handle value, RegionMotion& to, const std::string& where) {
  to = parse_region_motion(text_of(value, where));
}

void assign(nb::handle value, FrameRange& to, const std::string& where) {
  const std::vector<nb::object> three = items(value, where, "(first, end, step)");
  if (three.size() != 3) refuse(value, where, "(first, end, step)");
  to.first = whole<std::int64_t>(three[0], where);
  to.end = three[1].is_none() ? kToTheEnd : whole<std::int64_t>(three[1], where);
  to.step = whole<std::int64_t>(three[2], where);
}

void assign(nb::handle value, std::optional<Roi>& to, const std::string& where) {
  const std::vector<nb::object> four = items(value, where, "(x, y, width, height)");
  if (four.size() != 4) refuse(value, where, "(x, y, width, height)");
  to = Roi{whole<int>(four[0], where), whole<int>(four[1], where), whole<int>(four[2], where),
           whole<int>(four[3], where)};
}

void assign(nb::handle value, std::optional<RadiusRange>& to, const std::string& where) {
  const std::vector<double> two = numbers(value, 2, where);
  to = RadiusRange{two[0], two[1]};
}

void assign(nb::handle value, std::optional<RawLayout>& to, const std::string& where) {
  const std::vector<nb::object> three = items(value, where, "(width, height, bits)");
  if (three.size() != 3) refuse(value, where, "(width, height, bits)");
  to = RawLayout{whole<int>(three[0], where), whole<int>(three[1], where),
                 whole<int>(three[2], where)};
}

void assign(nb::handle value, std::vector<PointPx>& to, const std::string& where) {
  to.clear();
  for (const nb::object& corner : items(value, where, "a list of points")) {
    const std::vector<double> two = numbers(corner, 2, where);
    to.push_back({two[0], two[1]});
  }
}

void assign(nb::handle value, std::vector<BallByHand>& to, const std::string& where) {
  constexpr char kWanted[] = "{frame: (x, y, radius) or None, ...}";
  if (!nb::isinstance<nb::dict>(value)) refuse(value, where, kWanted);
  to.clear();
  for (const auto& [frame, circle] : nb::borrow<nb::dict>(value)) {
    BallByHand ball;
    ball.frame = whole<std::int64_t>(frame, where);
    if (!circle.is_none()) {
      const std::vector<double> three = numbers(circle, 3, where);
      if (!(three[2] > 0)) refuse(value, where, kWanted);
      ball = {ball.frame, three[0], three[1], three[2]};
    }
    to.push_back(ball);
  }
  std::sort(to.begin(), to.end(),
            [](const BallByHand& a, const BallByHand& b) { return a.frame < b.frame; });
}

OptionReader::OptionReader(const nb::dict& values) {
  for (const auto& [key, value] : values) {
    values_[nb::cast<nb::str>(key).c_str()] = nb::borrow(value);
  }
}

void OptionReader::finish(const std::string& job) const {
  for (const auto& [key, value] : values_) {
    if (known_.count(key)) continue;
    std::string names;
    for (const std::string& name : known_) names += (names.empty() ? "" : ", ") + name;
    throw InvalidArgument("there is no such option", job + ", " + key, "it has " + names);
  }
}

}  // namespace impactdic::python
