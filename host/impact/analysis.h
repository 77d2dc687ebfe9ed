// How analyse_impact looks for an impact. Internal.
#pragma once

#include <functional>

#include "host/impact/contact_edge.h"
#include "host/impact/evidence/contact_guess.h"
#include "host/impact/flight_fit.h"
#include "host/impact/free_radius.h"
#include "host/impact/impact_figures.h"
#include "host/impact/impact_phases.h"
#include "host/impact/impact_series.h"

namespace impactdic::impact {

// One way to an impact in a track, from the guess to the figures; each of them is run once.
class Analysis {
 public:
  Analysis(const TrackRows& rows, const ImpactOptions& options);

  // Of the contact that the steps show, or the centres where there are none.
  ImpactAnalysis run();
  // Of film so slow that few centres show each flight and none the contact.
  ImpactAnalysis run_sparse();
  // Of a ball whose motion is lost in most frames about its impact.
  ImpactAnalysis run_centres();

 private:
  bool set_flights();
  void limit_flights();
  void fit_both() {
    flights_ = fit_flights(series_, before_, after_, direction_, options_.gravity);
  }
  bool is_evident(bool with_flights, double odds) const;
  bool is_impact() const;
  void find_contact();
  bool back_off();
  void refit(double length);
  void find_edges(double start_guess, double end_guess);
  ContactEdge edge(bool end, double near, bool likeliest_alone) const;
  double edge_per_gravity(bool end) const;
  void set_radius(const FreeRadius& radius);
  using Instant = std::function<double(const ImpactSources::Vector&)>;
  ImpactSources sources(bool timed) const;
  Propagated above_lowest(const ImpactSources& sources, const Instant& instant) const;
  void place(const ImpactSources& sources, bool timed);
  void finish();

  TrackRows rows_;
  ImpactOptions options_;
  ImpactSeries series_;
  GravityDirection direction_;
  ContactGuess guess_;
  FlightRange before_, after_;
  FlightFit flights_;
  TurnInstant turn_;
  ContactEdge start_, end_;
  double contact_ = 0;  // frames that the surface acts for, as far as is known without its edges
  ImpactAnalysis result_;
};

}  // namespace impactdic::impact
