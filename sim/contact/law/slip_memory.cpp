#include "sim/contact/law/slip_memory.h"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

namespace impactdic::sim::contact {

namespace {

template <typename Real>
using Polynomial = std::array<Real, 6>;

template <typename Real, typename Number>
Number polynomial(const Polynomial<Real>& c, const Number& z) {
  return c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * c[5]))));
}

template <typename Real, typename Number>
Number slope_of(const Polynomial<Real>& c, const Number& z) {
  return c[1] + z * (2.0 * c[2] + z * (3.0 * c[3] + z * (4.0 * c[4] + z * 5.0 * c[5])));
}

// The quintic on [0, 1] with these values, first and second derivatives at its ends.
template <typename Real>
Polynomial<Real> quintic(const Real& f0, const Real& d0, const Real& s0, const Real& f1,
                         const Real& d1, const Real& s1) {
  const Real rise = f1 - f0 - d0 - 0.5 * s0, turn = d1 - d0 - s0, bend = s1 - s0;
  return {f0,
          d0,
          0.5 * s0,
          10.0 * rise - 4.0 * turn + 0.5 * bend,
          -15.0 * rise + 7.0 * turn - bend,
          6.0 * rise - 3.0 * turn + 0.5 * bend};
}

// Where the polynomial takes this value, from 0 to `high`: Newton's method kept inside a shrinking
// bracket. One step more of it gives the derivatives of what is exact in value.
template <typename Real>
Real root_of(const Polynomial<Real>& c, const Real& value, double high, double guess) {
  const Polynomial<double> plain = values_of(c);
  double low = 0, tau = guess;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double beyond = polynomial(plain, tau) - value_of(value);
    (beyond > 0 ? high : low) = tau;
    double next = tau - beyond / slope_of(plain, tau);
    const bool bisect = !(next >= low && next <= high);
    if (bisect) next = 0.5 * (low + high);
    // The error that is left is of the order of the step's square.
    const double step = std::abs(next - tau);
    tau = next;
    if (step <= (bisect ? 1e-15 : 1e-8)) break;
  }
  if constexpr (kHasDerivatives<Real>) {
    const Real off = polynomial(c, Real(tau)) - value;
    const double slope = slope_of(plain, tau);
    return slope == 0 ? Real(tau) : Real(tau, -off.v / slope);
  } else {
    return tau;
  }
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

template <typename Real>
void SlipMemory<Real>::clear() {
  pieces_.clear();
  hint_ = 0;
}

template <typename Real>
auto SlipMemory<Real>::trail_piece(const TrailPoint& from, const TrailPoint& to) -> Piece {
  const Real h = to.time_s - from.time_s;
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

template <typename Real>
void SlipMemory<Real>::append(Piece piece) {
  if (!pieces_.empty()) {
    const Piece& last = pieces_.back();
    piece.sum_before = last.sum_before + integral(last, end_of(last, 0));
  }
  pieces_.push_back(piece);
}

template <typename Real>
void SlipMemory<Real>::append_trail(const TrailPoint& from, const TrailPoint& to) {
  Piece piece = trail_piece(from, to);
  // g of one trail is smooth across its steps.
  piece.corner = !pieces_.empty() && (broken_ || !pieces_.back().trail);
  broken_ = false;
  if (!pieces_.empty()) piece.begin = pieces_.back().end;
  append(piece);
}

template <typename Real>
void SlipMemory<Real>::append_line(const Real& end, const Real& value, const Real& slope) {
  Piece piece;
  piece.begin = pieces_.empty() ? Real(0) : pieces_.back().end;
  piece.end = end;
  piece.begin_value = value;
  piece.slope = slope;
  piece.end_value = value + slope * (end - piece.begin);
  piece.corner = true;
  append(piece);
}

template <typename Real>
void SlipMemory<Real>::follow(const SlipEdge& edge) {
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

template <typename Real>
auto SlipMemory<Real>::end_of(const Piece& piece, std::size_t index) -> Place {
  return {index, piece.end, piece.end_value, piece.end_tau};
}

// g lies beyond the edge by side (s + g) - alpha (D - xi), which does not decrease with xi: g is
// nowhere steeper than alpha. So the edge meets g once.
template <typename Real>
auto SlipMemory<Real>::meet(const SlipEdge& edge) const -> Place {
  const auto beyond = [&](const Real& xi, const Real& value) {
    return edge.side * (edge.way_m + value) - edge.alpha * (edge.depth_m - xi);
  };
  if (pieces_.empty() || beyond(Real(0), pieces_.front().begin_value) >= 0) return {};
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
template <typename Real>
auto SlipMemory<Real>::meet_in(std::size_t index, const SlipEdge& edge) const -> Place {
  const Piece& piece = pieces_[index];
  if (!piece.trail) {
    const Real begin =
        edge.side * (edge.way_m + piece.begin_value) - edge.alpha * (edge.depth_m - piece.begin);
    const Real slope = edge.side * piece.slope + edge.alpha;
    // A line along the edge is all of it stuck, or all of it swept away (corner_below).
    if (!(slope > 1e-6 * edge.alpha)) return end_of(piece, index);
    const Real xi = std::clamp<Real>(piece.begin - begin / slope, piece.begin, piece.end);
    return {index, xi, piece.begin_value + piece.slope * (xi - piece.begin), Real(0)};
  }
  // side (s + g) - alpha (D - xi) as one polynomial of tau.
  Polynomial<Real> beyond;
  for (std::size_t k = 0; k < beyond.size(); ++k) {
    beyond[k] = edge.alpha * piece.depth[k] - edge.side * piece.way[k];
  }
  beyond[0] += edge.side * edge.way_m - edge.alpha * edge.depth_m;
  const double high = value_of(piece.end_tau), begin = value_of(beyond[0]);
  const double rise = value_of(polynomial(beyond, Real(high))) - begin;
  const double guess = rise > 0 ? std::clamp(-begin / rise, 0.0, 1.0) * high : 0.5 * high;
  const Real tau = root_of(beyond, Real(0), high, guess);
  return {index, polynomial(piece.depth, tau), -polynomial(piece.way, tau), tau};
}

template <typename Real>
Real SlipMemory<Real>::value_at(const Real& xi) const {
  std::size_t index = std::min(rim_hint_, pieces_.size() - 1);
  while (index > 0 && xi < pieces_[index].begin) --index;
  while (index + 1 < pieces_.size() && xi > pieces_[index].end) ++index;
  rim_hint_ = index;
  const Piece& piece = pieces_[index];
  if (!piece.trail) return piece.begin_value + piece.slope * (xi - piece.begin);
  const Real tau = root_of(piece.depth, xi, 1, 0.5);
  return -polynomial(piece.way, tau);
}

template <typename Real>
Real SlipMemory<Real>::excess_at_rim(const SlipEdge& edge) const {
  const Real rim = std::min<Real>(edge.depth_m, end());
  const Real value = rim < end() ? value_at(at_least(rim, 0)) : pieces_.back().end_value;
  return edge.side * (edge.way_m + value) - edge.alpha * (edge.depth_m - rim);
}

template <typename Real>
auto SlipMemory<Real>::stuck(const SlipEdge& edge) const -> Stuck {
  if (pieces_.empty()) return {};
  const Place place = meet(edge);
  if (!(place.xi > 0)) return {};
  const Piece& piece = pieces_[place.piece];
  return {std::min<Real>(place.xi, at_least(edge.depth_m, 0)),
          piece.sum_before + integral(piece, place)};
}

// int g dx = [g x] - int x dg, and along a trail -dg = ds.
template <typename Real>
Real SlipMemory<Real>::integral(const Piece& piece, const Place& to) const {
  const Real x0 = root(radius_ * piece.begin), x1 = root(radius_ * to.xi);
  if (!piece.trail) {
    const Real flat = piece.begin_value - piece.slope * piece.begin;
    return flat * (x1 - x0) + piece.slope * (x1 * x1 * x1 - x0 * x0 * x0) / (3.0 * radius_);
  }
  const Real sum = to.value * x1 - piece.begin_value * x0;
  // x grows like the root of the time at the touch.
  const bool touch = !(piece.begin > 0);
  if constexpr (kHasDerivatives<Real>) {
    Real moments{};
    for (Eigen::Index i = 0; i < kGauss.at.size(); ++i) {
      const double w = kGauss.at[i];
      const Real tau = to.tau * (touch ? w * w : w);
      const Real x = root(radius_ * at_least(polynomial(piece.depth, tau), 0));
      moments += kGauss.weight[i] * (touch ? 2 * w : 1) * x * slope_of(piece.way, tau);
    }
    return sum + to.tau * moments;
  } else {
    const auto moment = [&](const Nodes& tau) -> Nodes {
      return (radius_ * polynomial(piece.depth, tau).max(0.0)).sqrt() * slope_of(piece.way, tau);
    };
    const Nodes& w = kGauss.at;
    if (!touch) return sum + to.tau * (kGauss.weight * moment(to.tau * w)).sum();
    return sum + 2.0 * to.tau * (kGauss.weight * w * moment(to.tau * w * w)).sum();
  }
}

// int u^2 dx = [u^2 x] - 2 int x u du with u = s + g, and along a trail -du = ds. Of energies no
// derivatives are asked.
template <typename Real>
Real SlipMemory<Real>::square_integral(const Piece& piece, const Place& to,
                                       const Real& way_m) const {
  if constexpr (kHasDerivatives<Real>) {
    return Real(0);
  } else {
    const double x0 = std::sqrt(radius_ * piece.begin), x1 = std::sqrt(radius_ * to.xi);
    if (!piece.trail) {
      const auto square = [&](const double x) {
        const double u = way_m + piece.begin_value + piece.slope * (x * x / radius_ - piece.begin);
        return u * u;
      };
      return Gauss::integrate(square, x0, x1);
    }
    const auto moment = [&](const double tau) {
      return 2.0 * std::sqrt(radius_ * std::max(polynomial(piece.depth, tau), 0.0)) *
             (way_m - polynomial(piece.way, tau)) * slope_of(piece.way, tau);
    };
    const double u0 = way_m + piece.begin_value, u1 = way_m + to.value;
    const double sum = u1 * u1 * x1 - u0 * u0 * x0;
    if (piece.begin > 0) return sum + Gauss::integrate(moment, 0.0, to.tau);
    const auto rooted = [&](const double w) { return 2.0 * to.tau * w * moment(to.tau * w * w); };
    return sum + Gauss::integrate(rooted, 0.0, 1.0);
  }
}

template <typename Real>
Real SlipMemory<Real>::squares_before(std::size_t index, const Real& way_m) const {
  Real sum{};
  for (std::size_t i = 0; i < index; ++i) {
    sum += square_integral(pieces_[i], end_of(pieces_[i], i), way_m);
  }
  return sum;
}

template <typename Real>
Real SlipMemory<Real>::square_sum_to(const SlipEdge& edge) const {
  if (pieces_.empty()) return Real(0);
  const Place place = meet(edge);
  return squares_before(place.piece, edge.way_m) +
         square_integral(pieces_[place.piece], place, edge.way_m);
}

template <typename Real>
Real SlipMemory<Real>::square_sum(const Real& way_m) const {
  return squares_before(pieces_.size(), way_m);
}

template <typename Real>
Real SlipMemory<Real>::square_sum_of_trail(const TrailPoint& from, const TrailPoint& to) const {
  const Piece piece = trail_piece(from, to);
  return square_integral(piece, end_of(piece, 0), to.way_m);
}

template <typename Real>
auto SlipMemory<Real>::corner_below(const Real& xi) const -> Corner {
  if (pieces_.empty()) return {};
  Corner below{Real(0), pieces_.front().begin_value};
  for (const Piece& piece : pieces_) {
    if (piece.corner && piece.begin < xi) below = {piece.begin, piece.begin_value};
  }
  return below;
}

template <typename Real>
Real SlipMemory<Real>::excess_at_corner(const Corner& corner, const SlipEdge& edge) {
  return edge.side * (edge.way_m + corner.value) - edge.alpha * (edge.depth_m - corner.xi);
}

template class SlipMemory<double>;
template class SlipMemory<Sensitive>;

}  // namespace impactdic::sim::contact
