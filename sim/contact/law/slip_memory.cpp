#include "sim/contact/law/slip_memory.h"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

namespace impactdic::sim::contact {

namespace {

using Polynomial = std::array<double, 6>;

template <typename Number>
Number value_of(const Polynomial& c, const Number& z) {
  return c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * c[5]))));
}

template <typename Number>
Number slope_of(const Polynomial& c, const Number& z) {
  return c[1] + z * (2 * c[2] + z * (3 * c[3] + z * (4 * c[4] + z * 5 * c[5])));
}

// The quintic on [0, 1] with these values, first and second derivatives at its ends.
Polynomial quintic(double f0, double d0, double s0, double f1, double d1, double s1) {
  const double rise = f1 - f0 - d0 - 0.5 * s0, turn = d1 - d0 - s0, bend = s1 - s0;
  return {f0,
          d0,
          0.5 * s0,
          10 * rise - 4 * turn + 0.5 * bend,
          -15 * rise + 7 * turn - bend,
          6 * rise - 3 * turn + 0.5 * bend};
}

using Gauss = boost::math::quadrature::gauss<double, 7>;

// The nodes of Gauss's rule on [0, 1], all at once.
using Nodes = Eigen::Array<double, 8, 1>;
struct GaussRule {
  Nodes at, weight;
};

GaussRule gauss_rule() {
  using Rule = boost::math::quadrature::gauss<double, 8>;
  GaussRule rule;
  for (int i = 0; i < 4; ++i) {
    rule.at[i] = 0.5 * (1 - Rule::abscissa()[i]), rule.at[4 + i] = 0.5 * (1 + Rule::abscissa()[i]);
    rule.weight[i] = rule.weight[4 + i] = 0.5 * Rule::weights()[i];
  }
  return rule;
}
const GaussRule kGauss = gauss_rule();

}  // namespace

void SlipMemory::clear() {
  pieces_.clear();
  hint_ = 0;
}

SlipMemory::Piece SlipMemory::trail_piece(const TrailPoint& from, const TrailPoint& to) {
  const double h = to.time_s - from.time_s;
  Piece piece;
  piece.trail = true;
  piece.begin = from.depth_m;
  piece.end = to.depth_m;
  piece.begin_value = -from.way_m;
  piece.end_value = -to.way_m;
  piece.depth = quintic(from.depth_m, h * from.depth_rate, h * h * from.depth_acceleration,
                        to.depth_m, h * to.depth_rate, h * h * to.depth_acceleration);
  piece.way = quintic(from.way_m, h * from.way_rate, h * h * from.way_acceleration, to.way_m,
                      h * to.way_rate, h * h * to.way_acceleration);
  return piece;
}

void SlipMemory::append(Piece piece) {
  if (!pieces_.empty()) {
    const Piece& last = pieces_.back();
    piece.sum_before = last.sum_before + integral(last, end_of(last, 0));
  }
  pieces_.push_back(piece);
}

void SlipMemory::append_trail(const TrailPoint& from, const TrailPoint& to) {
  Piece piece = trail_piece(from, to);
  // g of one trail is smooth across its steps.
  piece.corner = !pieces_.empty() && (broken_ || !pieces_.back().trail);
  broken_ = false;
  if (!pieces_.empty()) piece.begin = pieces_.back().end;
  append(piece);
}

void SlipMemory::append_line(double end, double value, double slope) {
  Piece piece;
  piece.begin = pieces_.empty() ? 0.0 : pieces_.back().end;
  piece.end = end;
  piece.begin_value = value;
  piece.slope = slope;
  piece.end_value = value + slope * (end - piece.begin);
  piece.corner = true;
  append(piece);
}

void SlipMemory::follow(const SlipEdge& edge) {
  const Place place = empty() ? Place{} : meet(edge);
  while (!pieces_.empty() && pieces_.back().begin >= place.xi) pieces_.pop_back();
  if (!pieces_.empty()) {
    pieces_.back().end = place.xi;
    pieces_.back().end_value = place.value;
    pieces_.back().end_tau = place.tau;
  }
  hint_ = 0;
  if (edge.depth_m > place.xi) {
    append_line(edge.depth_m, edge.side * edge.alpha * (edge.depth_m - place.xi) - edge.way_m,
                -edge.side * edge.alpha);
  }
}

SlipMemory::Place SlipMemory::end_of(const Piece& piece, std::size_t index) {
  return {index, piece.end, piece.end_value, piece.end_tau};
}

// g lies beyond the edge by side (s + g) - alpha (D - xi), which does not decrease with xi: g is
// nowhere steeper than alpha. So the edge meets g once.
SlipMemory::Place SlipMemory::meet(const SlipEdge& edge) const {
  const auto beyond = [&](double xi, double value) {
    return edge.side * (edge.way_m + value) - edge.alpha * (edge.depth_m - xi);
  };
  if (pieces_.empty() || beyond(0, pieces_.front().begin_value) >= 0) return {};
  std::size_t index = std::min(hint_, pieces_.size() - 1);
  while (index > 0 && beyond(pieces_[index].begin, pieces_[index].begin_value) >= 0) --index;
  while (index + 1 < pieces_.size() && beyond(pieces_[index].end, pieces_[index].end_value) < 0) {
    ++index;
  }
  hint_ = index;
  const Piece& piece = pieces_[index];
  if (beyond(piece.end, piece.end_value) <= 0) return end_of(piece, index);
  return meet_in(index, edge);
}

// Newton's method kept inside a shrinking bracket.
SlipMemory::Place SlipMemory::meet_in(std::size_t index, const SlipEdge& edge) const {
  const Piece& piece = pieces_[index];
  if (!piece.trail) {
    const double begin =
        edge.side * (edge.way_m + piece.begin_value) - edge.alpha * (edge.depth_m - piece.begin);
    const double slope = edge.side * piece.slope + edge.alpha;
    // A line along the edge is all of it stuck, or all of it swept away (corner_below).
    if (!(slope > 1e-6 * edge.alpha)) return end_of(piece, index);
    const double xi = std::clamp(piece.begin - begin / slope, piece.begin, piece.end);
    return {index, xi, piece.begin_value + piece.slope * (xi - piece.begin), 0};
  }
  // side (s + g) - alpha (D - xi) as one polynomial of tau.
  Polynomial beyond;
  for (std::size_t k = 0; k < beyond.size(); ++k) {
    beyond[k] = edge.alpha * piece.depth[k] - edge.side * piece.way[k];
  }
  beyond[0] += edge.side * edge.way_m - edge.alpha * edge.depth_m;
  double low = 0, high = piece.end_tau;
  const double rise = value_of(beyond, high) - beyond[0];
  double tau = rise > 0 ? std::clamp(-beyond[0] / rise, 0.0, 1.0) * high : 0.5 * high;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double value = value_of(beyond, tau);
    (value > 0 ? high : low) = tau;
    double next = tau - value / slope_of(beyond, tau);
    const bool bisect = !(next >= low && next <= high);
    if (bisect) next = 0.5 * (low + high);
    // The error that is left is of the order of the step's square.
    const double step = std::abs(next - tau);
    tau = next;
    if (step <= (bisect ? 1e-15 : 1e-8)) break;
  }
  return {index, value_of(piece.depth, tau), -value_of(piece.way, tau), tau};
}

double SlipMemory::value_at(double xi) const {
  std::size_t index = std::min(rim_hint_, pieces_.size() - 1);
  while (index > 0 && xi < pieces_[index].begin) --index;
  while (index + 1 < pieces_.size() && xi > pieces_[index].end) ++index;
  rim_hint_ = index;
  const Piece& piece = pieces_[index];
  if (!piece.trail) return piece.begin_value + piece.slope * (xi - piece.begin);
  double low = 0, high = 1, tau = 0.5;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double beyond = value_of(piece.depth, tau) - xi;
    (beyond > 0 ? high : low) = tau;
    double next = tau - beyond / slope_of(piece.depth, tau);
    const bool bisect = !(next >= low && next <= high);
    if (bisect) next = 0.5 * (low + high);
    const double step = std::abs(next - tau);
    tau = next;
    if (step <= (bisect ? 1e-15 : 1e-8)) break;
  }
  return -value_of(piece.way, tau);
}

double SlipMemory::excess_at_rim(const SlipEdge& edge) const {
  const double rim = std::min(edge.depth_m, end());
  const double value = rim < end() ? value_at(std::max(rim, 0.0)) : pieces_.back().end_value;
  return edge.side * (edge.way_m + value) - edge.alpha * (edge.depth_m - rim);
}

SlipMemory::Stuck SlipMemory::stuck(const SlipEdge& edge) const {
  if (pieces_.empty()) return {};
  const Place place = meet(edge);
  if (!(place.xi > 0)) return {};
  const Piece& piece = pieces_[place.piece];
  return {std::min(place.xi, std::max(edge.depth_m, 0.0)),
          piece.sum_before + integral(piece, place)};
}

// int g dx = [g x] - int x dg, and along a trail -dg = ds.
double SlipMemory::integral(const Piece& piece, const Place& to) const {
  const double x0 = std::sqrt(radius_ * piece.begin), x1 = std::sqrt(radius_ * to.xi);
  if (!piece.trail) {
    const double flat = piece.begin_value - piece.slope * piece.begin;
    return flat * (x1 - x0) + piece.slope * (x1 * x1 * x1 - x0 * x0 * x0) / (3 * radius_);
  }
  const auto moment = [&](const Nodes& tau) -> Nodes {
    return (radius_ * value_of(piece.depth, tau).max(0.0)).sqrt() * slope_of(piece.way, tau);
  };
  const double sum = to.value * x1 - piece.begin_value * x0;
  const Nodes& w = kGauss.at;
  if (piece.begin > 0) return sum + to.tau * (kGauss.weight * moment(to.tau * w)).sum();
  // x grows like the root of the time at the touch.
  return sum + 2 * to.tau * (kGauss.weight * w * moment(to.tau * w * w)).sum();
}

// int u^2 dx = [u^2 x] - 2 int x u du with u = s + g, and along a trail -du = ds.
double SlipMemory::square_integral(const Piece& piece, const Place& to, double way_m) const {
  const double x0 = std::sqrt(radius_ * piece.begin), x1 = std::sqrt(radius_ * to.xi);
  if (!piece.trail) {
    const auto square = [&](double x) {
      const double u = way_m + piece.begin_value + piece.slope * (x * x / radius_ - piece.begin);
      return u * u;
    };
    return Gauss::integrate(square, x0, x1);
  }
  const auto moment = [&](double tau) {
    return 2 * std::sqrt(radius_ * std::max(value_of(piece.depth, tau), 0.0)) *
           (way_m - value_of(piece.way, tau)) * slope_of(piece.way, tau);
  };
  const double u0 = way_m + piece.begin_value, u1 = way_m + to.value;
  const double sum = u1 * u1 * x1 - u0 * u0 * x0;
  if (piece.begin > 0) return sum + Gauss::integrate(moment, 0.0, to.tau);
  const auto rooted = [&](double w) { return 2 * to.tau * w * moment(to.tau * w * w); };
  return sum + Gauss::integrate(rooted, 0.0, 1.0);
}

double SlipMemory::squares_before(std::size_t index, double way_m) const {
  double sum = 0;
  for (std::size_t i = 0; i < index; ++i) {
    sum += square_integral(pieces_[i], end_of(pieces_[i], i), way_m);
  }
  return sum;
}

double SlipMemory::square_sum_to(const SlipEdge& edge) const {
  if (pieces_.empty()) return 0;
  const Place place = meet(edge);
  return squares_before(place.piece, edge.way_m) +
         square_integral(pieces_[place.piece], place, edge.way_m);
}

double SlipMemory::square_sum(double way_m) const { return squares_before(pieces_.size(), way_m); }

double SlipMemory::square_sum_of_trail(const TrailPoint& from, const TrailPoint& to) const {
  const Piece piece = trail_piece(from, to);
  return square_integral(piece, end_of(piece, 0), to.way_m);
}

SlipMemory::Corner SlipMemory::corner_below(double xi) const {
  if (pieces_.empty()) return {};
  Corner below{0, pieces_.front().begin_value};
  for (const Piece& piece : pieces_) {
    if (piece.corner && piece.begin < xi) below = {piece.begin, piece.begin_value};
  }
  return below;
}

double SlipMemory::excess_at_corner(const Corner& corner, const SlipEdge& edge) {
  return edge.side * (edge.way_m + corner.value) - edge.alpha * (edge.depth_m - corner.xi);
}

}  // namespace impactdic::sim::contact
