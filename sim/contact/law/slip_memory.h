// What the springs of a partially slipping contact remember (maw_barber_fawcett.cpp).
//
// A spring at xi = x^2/R that sticks stands at u = s + g(xi), where s is the way of the contact
// point and g does not change while it sticks. Two things lay g down: springs touched while all
// others stick start from u = 0, so that g = -s at the touch (a trail); and an annulus that comes
// to rest at its bound u = side alpha (D - xi) keeps that line.
//
// A trail is kept as two polynomials of time, D and s, and not as one of xi: where the contact
// stops growing, g has a vertical tangent in xi, and none in time.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sim/contact/numbers/real.h"

namespace impactdic::sim::contact {

// The tangential contact at one instant: its depth D, the way s, and their rates.
template <typename Real>
struct TrailPoint {
  Real time_s{};
  Real depth_m{}, depth_rate{}, depth_acceleration{};
  Real way_m{}, way_rate{}, way_acceleration{};
};

// The straight edge of an annulus that slips: u = side alpha (depth - xi).
template <typename Real>
struct SlipEdge {
  double side = 1;
  Real alpha{}, depth_m{}, way_m{};
};

template <typename Real>
class SlipMemory {
 public:
  using TrailPoint = contact::TrailPoint<Real>;
  using SlipEdge = contact::SlipEdge<Real>;

  explicit SlipMemory(const Real& radius_m) : radius_(radius_m) {}

  void clear();
  bool empty() const { return pieces_.empty(); }
  // The outermost spring that is remembered.
  const Real& end() const { return pieces_.back().end; }

  // Springs from the present end (0 at first) to `to.depth_m`, touched one after the other.
  void append_trail(const TrailPoint& from, const TrailPoint& to);
  // The next piece of a trail does not go on smoothly.
  void break_trail() { broken_ = true; }
  // Springs from the present end to xi = end on g = value + slope (xi - begin).
  void append_line(const Real& end, const Real& value, const Real& slope);
  // Forgets all springs beyond where the edge meets g, and follows the edge from there.
  void follow(const SlipEdge& edge);

  // The springs that stick.
  struct Stuck {
    Real xi{};   // up to there; 0: none
    Real sum{};  // int g dx from 0 to that place
  };
  Stuck stuck(const SlipEdge& edge) const;
  // int (s + g)^2 dx over them.
  Real square_sum_to(const SlipEdge& edge) const;
  // The same over all that is remembered, and over the trail that would be appended.
  Real square_sum(const Real& way_m) const;
  Real square_sum_of_trail(const TrailPoint& from, const TrailPoint& to) const;

  // How far g lies beyond the edge at the contact's rim, or at the end of the memory where the
  // contact is larger. Below zero the edge no longer meets g: the annulus is gone.
  Real excess_at_rim(const SlipEdge& edge) const;
  // A place at which g is not smooth.
  struct Corner {
    Real xi{}, value{};
  };
  // The next one below xi that an edge will reach; that at 0 is the last.
  Corner corner_below(const Real& xi) const;
  // How far g at a corner lies beyond the edge; it grows with xi.
  static Real excess_at_corner(const Corner& corner, const SlipEdge& edge);

 private:
  struct Piece {
    bool trail = false;
    Real begin{}, end{};  // xi
    Real begin_value{}, end_value{};
    Real slope{};  // of a line
    // Of a trail: polynomials of tau = (t - t0)/(t1 - t0), and the tau of `end`.
    std::array<Real, 6> depth{}, way{};
    Real end_tau{1};
    bool corner = false;  // g is not smooth at `begin`
    Real sum_before{};    // int g dx from 0 to `begin`
  };
  // Where an edge meets g: piece, and the place in it.
  struct Place {
    std::size_t piece = 0;
    Real xi{}, value{}, tau{};
  };

  static Piece trail_piece(const TrailPoint& from, const TrailPoint& to);
  Place meet(const SlipEdge& edge) const;
  Place meet_in(std::size_t index, const SlipEdge& edge) const;
  Real value_at(const Real& xi) const;
  Real integral(const Piece& piece, const Place& to) const;
  Real square_integral(const Piece& piece, const Place& to, const Real& way_m) const;
  Real squares_before(std::size_t index, const Real& way_m) const;
  static Place end_of(const Piece& piece, std::size_t index);
  void append(Piece piece);

  Real radius_;
  bool broken_ = false;
  std::vector<Piece> pieces_;                    // ascending in xi from 0, without gaps
  mutable std::size_t hint_ = 0, rim_hint_ = 0;  // where the last search ended: speed only
};

}  // namespace impactdic::sim::contact
