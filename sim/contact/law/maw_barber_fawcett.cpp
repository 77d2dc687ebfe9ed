// Partial slip with friction memory: Maw, Barber and Fawcett (1976), by the method of
// dimensionality reduction (Popov and Hess 2015).
//
// Independent springs stand at |x| <= a = sqrt(R delta). With xi = x^2/R, a spring is pressed by
// u_z = delta - xi, dragged by the contact point, and clipped to |u| <= c = alpha (delta - xi) with
// alpha = mu E*/G*. Hence F_n = E* int u_z dx and F_t = -G* int u dx.
//
// All stuck springs move at the rate v of the contact point and all slipping ones at +-alpha
// delta', whatever their place. So the profile is known exactly at any time without following
// springs: an inner stuck part u = s + g(xi), where s is the way of the contact point and g the
// memory, and an outer annulus at one of the bounds. Only the places where the mode changes are
// events, and the memory g is kept as polynomial pieces in xi.
#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <vector>

#include "sim/contact/law/friction_law.h"

namespace impactdic::sim::contact {

namespace {

// g on [begin, end], a polynomial in z = xi - begin.
struct Piece {
  double begin = 0, end = 0;
  std::array<double, 6> c{};
  bool corner = false;       // g is not smooth at `begin`
  bool along_bound = false;  // a slipped part that has come to rest: slope +-alpha
  double sum_before = 0;     // int g dx from 0 to x(begin)

  double value(double xi) const {
    const double z = xi - begin;
    return c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * c[5]))));
  }
  double slope(double xi) const {
    const double z = xi - begin;
    return c[1] + z * (2 * c[2] + z * (3 * c[3] + z * (4 * c[4] + z * 5 * c[5])));
  }
};

// Value, first and second derivative of g with respect to xi.
struct Jet {
  double value, slope, curvature;
};

// The quintic through both jets.
Piece hermite_piece(double begin, double end, const Jet& from, const Jet& to) {
  const double h = end - begin;
  const double d0 = h * from.slope, s0 = h * h * from.curvature;
  const double rise = to.value - from.value - d0 - 0.5 * s0;
  const double turn = h * to.slope - d0 - s0;
  const double bend = h * h * to.curvature - s0;
  Piece piece;
  piece.begin = begin;
  piece.end = end;
  piece.c = {from.value,
             from.slope,
             0.5 * from.curvature,
             (10 * rise - 4 * turn + 0.5 * bend) / (h * h * h),
             (-15 * rise + 7 * turn - bend) / (h * h * h * h),
             (6 * rise - 3 * turn + 0.5 * bend) / (h * h * h * h * h)};
  return piece;
}

class MawBarberFawcett final : public FrictionLaw {
 public:
  MawBarberFawcett(const ContactParameters& contact, double radius_m)
      : radius_(radius_m),
        friction_(contact.friction_kinetic),
        modulus_(0.75 * contact.stiffness / std::sqrt(radius_m)),
        shear_modulus_(modulus_ * 2 * (1 - contact.poisson) / (2 - contact.poisson)),
        alpha_(friction_ * modulus_ / shear_modulus_) {}

  void begin(const ContactPoint& at) override {
    pieces_.clear();
    touch_rate_ = at.rate_m_s;
    if (std::abs(at.tip_vt_m_s) <= alpha_ * at.rate_m_s) {
      start_sticking(at, 0);
      touching_ = true;
    } else {
      start_slip(at.tip_vt_m_s >= 0 ? 1 : -1);
    }
  }

  Traction traction(const ContactPoint& at) const override {
    Traction result;
    if (side_ == 0) {
      result.force_n = -2 * shear_modulus_ * sticking_sum(at);
      result.springs_rate_m2_s = sticking_rate(at, result.force_n);
      return result;
    }
    const double limit = gross_ ? 0.0 : stuck_to(at);
    result.force_n = -2 * shear_modulus_ * slipping_sum(at, limit);
    result.dissipation_w = 2 * shear_modulus_ * alpha_ *
                           (side_ * at.tip_vt_m_s - alpha_ * at.rate_m_s) * pressed(at, limit);
    return result;
  }

  int guards(const ContactPoint& at, Guards& values) const override {
    const double bound_rate = alpha_ * at.rate_m_s;
    if (side_ == 0) {
      values[0] = bound_rate - at.tip_vt_m_s;
      values[1] = bound_rate + at.tip_vt_m_s;
      values[2] = at.rate_m_s - 0.5 * touch_rate_;
      return touching_ ? 3 : 2;
    }
    values[0] = side_ * at.tip_vt_m_s - bound_rate;
    if (gross_) return 1;
    values[1] = -excess(at, corner_);
    return 2;
  }

  void cross(int guard, const ContactPoint& at) override {
    if (side_ == 0 && guard == 2) {
      start_sticking(at, sticking_sum(at));
    } else if (side_ == 0) {
      start_slip(guard == 0 ? 1 : -1);
    } else if (guard == 1) {
      next_corner(at);
    } else {
      // The annulus has come to rest. While the contact still grows all springs stick; while it
      // shrinks the opposite bound catches the outermost ones at once.
      const double sum = slipping_sum(at, gross_ ? 0.0 : stuck_to(at));
      freeze(at);
      if (at.rate_m_s > 0) {
        start_sticking(at, sum);
      } else {
        start_slip(-side_);
      }
    }
  }

  const char* mode() const override {
    if (side_ == 0) return "sticking";
    return gross_ ? "gross_slip" : "partial_slip";
  }

  void step(const ContactPoint& at) override {
    if (side_ != 0) return;
    if (at.deflection_m > recorded_.deflection_m) append(recorded_piece(at));
    recorded_ = at;
  }

  double stored_j(const ContactPoint& at) const override {
    if (at.deflection_m <= 0) return 0;
    const double stuck = side_ == 0 ? at.deflection_m : (gross_ ? 0.0 : stuck_to(at));
    double sum = integral_of_square(pieces_, at.tip_m, stuck);
    if (side_ == 0 && at.deflection_m > recorded_.deflection_m) {
      sum += integral_of_square({recorded_piece(at)}, at.tip_m, stuck);
    }
    const auto slipping = [&](double x) {
      const double u = alpha_ * (at.deflection_m - x * x / radius_);
      return u * u;
    };
    sum += Gauss<7>::integrate(slipping, std::sqrt(radius_ * stuck), contact_half_width(at));
    return shear_modulus_ * sum;
  }

 private:
  // For int g dx, of degree 10 in x, 7 points are exact; for int g^2 dx, of degree 20, 11 points.
  template <unsigned points>
  using Gauss = boost::math::quadrature::gauss<double, points>;

  // (2/3) a delta = int (delta - x^2/R) dx over the contact.
  double wedge(const ContactPoint& at) const {
    return 2.0 / 3.0 * contact_half_width(at) * at.deflection_m;
  }

  // The same over the annulus outside xi = limit.
  double pressed(const ContactPoint& at, double limit) const {
    const double inner = std::sqrt(radius_ * limit);
    return wedge(at) - inner * (at.deflection_m - limit / 3);
  }

  // delta' while all springs stick, kept from zero where a step looks beyond that.
  double approach(const ContactPoint& at) const {
    return std::max(at.rate_m_s, 1e-6 * touch_rate_);
  }

  double tip_acceleration(const ContactPoint& at, double force_n) const {
    return at.mobility_per_kg * (force_n - at.rolling_n);
  }

  // int u dx while all springs stick. Its rate, v a, grows like sqrt(t) at the touch, which no
  // integrator likes: there only the smooth remainder is integrated beside (2/3) a delta v/delta',
  // the sum that springs dragged along a straight path would have.
  double sticking_sum(const ContactPoint& at) const {
    const double sum = sticking_sum_ + at.springs_m2;
    return touching_ ? sum + wedge(at) * at.tip_vt_m_s / approach(at) : sum;
  }

  double sticking_rate(const ContactPoint& at, double force_n) const {
    if (!touching_) return at.tip_vt_m_s * contact_half_width(at);
    const double rate = approach(at);
    return -wedge(at) *
           (tip_acceleration(at, force_n) * rate - at.tip_vt_m_s * at.acceleration_m_s2) /
           (rate * rate);
  }

  // int u dx with an annulus outside xi = limit.
  double slipping_sum(const ContactPoint& at, double limit) const {
    double sum = side_ * alpha_ * pressed(at, limit);
    if (limit > 0) sum += at.tip_m * std::sqrt(radius_ * limit) + memory_sum(limit);
    return sum;
  }

  // int g dx from 0 to x(xi).
  double memory_sum(double xi) const {
    const Piece& piece = pieces_[piece_at(xi)];
    return piece.sum_before + integral(piece, xi);
  }

  double integral(const Piece& piece, double xi) const {
    const auto g = [&](double x) { return piece.value(x * x / radius_); };
    return Gauss<7>::integrate(g, std::sqrt(radius_ * piece.begin), std::sqrt(radius_ * xi));
  }

  void append(Piece piece) {
    if (!pieces_.empty()) {
      const Piece& last = pieces_.back();
      piece.sum_before = last.sum_before + integral(last, last.end);
    }
    pieces_.push_back(piece);
  }

  // `sum` is int u dx at this moment.
  void start_sticking(const ContactPoint& at, double sum) {
    side_ = 0;
    touching_ = false;
    recorded_ = at;
    sticking_sum_ = sum - at.springs_m2;
  }

  double contact_half_width(const ContactPoint& at) const {
    return std::sqrt(radius_ * std::max(at.deflection_m, 0.0));
  }

  // How far the stuck profile lies beyond the annulus's bound at xi; not decreasing in xi.
  double excess(const ContactPoint& at, double xi) const {
    return side_ * (at.tip_m + memory(xi)) - alpha_ * (at.deflection_m - xi);
  }

  double memory(double xi) const { return pieces_.empty() ? 0.0 : pieces_[piece_at(xi)].value(xi); }

  std::size_t piece_at(double xi) const {
    std::size_t index = std::min(hint_, pieces_.size() - 1);
    while (index > 0 && xi < pieces_[index].begin) --index;
    while (index + 1 < pieces_.size() && xi > pieces_[index].end) ++index;
    return hint_ = index;
  }

  // xi up to which the springs stick: the root of `excess`.
  double stuck_to(const ContactPoint& at) const {
    if (pieces_.empty() || excess(at, 0) >= 0) return 0;
    const double edge = std::min(at.deflection_m, pieces_.back().end);
    if (edge <= 0 || excess(at, edge) <= 0) return std::max(edge, 0.0);
    std::size_t index = piece_at(std::min(edge, boundary_hint_));
    while (index > 0 && excess_in(at, index, pieces_[index].begin) > 0) --index;
    while (index + 1 < pieces_.size() && excess_in(at, index, pieces_[index].end) < 0) ++index;
    hint_ = index;
    const double low = pieces_[index].begin, high = std::min(pieces_[index].end, edge);
    return boundary_hint_ = root_in(at, index, low, high);
  }

  double excess_in(const ContactPoint& at, std::size_t index, double xi) const {
    return side_ * (at.tip_m + pieces_[index].value(xi)) - alpha_ * (at.deflection_m - xi);
  }

  // Newton's method kept inside a shrinking bracket.
  double root_in(const ContactPoint& at, std::size_t index, double low, double high) const {
    double xi = std::clamp(boundary_hint_, low, high);
    for (int iteration = 0; iteration < 60; ++iteration) {
      const double value = excess_in(at, index, xi);
      (value > 0 ? high : low) = xi;
      const double slope = side_ * pieces_[index].slope(xi) + alpha_;
      double next = xi - value / slope;
      const bool bisect = !(next >= low && next <= high);
      if (bisect) next = 0.5 * (low + high);
      // The error that is left is of the order of the step's square; and `excess` is a difference
      // of lengths like the deflection, of which the rounding remains.
      const double step = std::abs(next - xi) / at.deflection_m;
      if (step <= (bisect ? 4e-16 : 1e-9)) return next;
      xi = next;
    }
    return xi;
  }

  void start_slip(int side) {
    side_ = side;
    gross_ = pieces_.empty();
    if (gross_) return;
    boundary_hint_ = pieces_.back().end;
    corner_ = 0;
    for (const Piece& piece : pieces_) {
      if (piece.corner) corner_ = piece.begin;
    }
  }

  // The annulus has reached a corner of the memory. A part of it that lies along the bound is taken
  // in one stroke.
  void next_corner(const ContactPoint& at) {
    const double along_bound = 1e-10 * alpha_ * at.deflection_m;
    while (corner_ > 0) {
      double below = 0;
      for (const Piece& piece : pieces_) {
        if (piece.corner && piece.begin < corner_) below = piece.begin;
      }
      corner_ = below;
      if (excess(at, corner_) < -along_bound) return;
    }
    gross_ = true;
  }

  // The profile as it stands becomes the memory.
  void freeze(const ContactPoint& at) {
    const double stuck = gross_ ? 0.0 : stuck_to(at);
    while (!pieces_.empty() && pieces_.back().begin >= stuck) pieces_.pop_back();
    if (!pieces_.empty()) pieces_.back().end = stuck;
    const double edge = std::max(at.deflection_m, 0.0);
    if (edge > stuck) {
      const double value = side_ * alpha_ * (at.deflection_m - stuck) - at.tip_m;
      append({stuck, edge, {value, -side_ * alpha_}, true, true});
    }
  }

  // Springs touched while everything sticks start from zero: g(xi) = -s at the touch.
  Piece recorded_piece(const ContactPoint& at) const {
    const auto jet = [this](const ContactPoint& p) {
      const double rate = approach(p);
      const double tip_rate = tip_acceleration(p, -2 * shear_modulus_ * sticking_sum(p));
      const double curvature =
          (tip_rate * rate - p.tip_vt_m_s * p.acceleration_m_s2) / (rate * rate * rate);
      return Jet{-p.tip_m, -p.tip_vt_m_s / rate, -curvature};
    };
    Piece piece = hermite_piece(recorded_.deflection_m, at.deflection_m, jet(recorded_), jet(at));
    piece.corner = !pieces_.empty() && pieces_.back().along_bound;
    return piece;
  }

  // int u^2 dx over the stuck part, 0 <= x <= sqrt(R limit), u = s + g.
  double integral_of_square(const std::vector<Piece>& pieces, double tip, double limit) const {
    double sum = 0;
    for (const Piece& piece : pieces) {
      const double end = std::min(piece.end, limit);
      if (end <= piece.begin) break;
      const auto square = [&](double x) {
        const double u = tip + piece.value(x * x / radius_);
        return u * u;
      };
      sum +=
          Gauss<11>::integrate(square, std::sqrt(radius_ * piece.begin), std::sqrt(radius_ * end));
    }
    return sum;
  }

  double radius_, friction_, modulus_, shear_modulus_, alpha_;
  std::vector<Piece> pieces_;     // of g, ascending in xi from 0, without gaps
  ContactPoint recorded_;         // where the record of a sticking loading has come to
  int side_ = 0;                  // 0: all springs stick; +-1: an annulus slips at +-c
  bool touching_ = false;         // all springs have stuck since the touch, not long ago
  double touch_rate_ = 0;         // delta' at the touch
  bool gross_ = false;            // the annulus covers everything
  double sticking_sum_ = 0;       // the constant of sticking_sum
  double corner_ = 0;             // the next corner that the annulus's inner edge will reach
  mutable std::size_t hint_ = 0;  // where the last search ended: speed only
  mutable double boundary_hint_ = 0;
};

}  // namespace

std::unique_ptr<FrictionLaw> make_maw_barber_fawcett(const ContactParameters& contact,
                                                     double radius_m) {
  return std::make_unique<MawBarberFawcett>(contact, radius_m);
}

}  // namespace impactdic::sim::contact
