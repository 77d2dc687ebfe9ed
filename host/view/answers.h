// What the page asks for, and the answers to it.
#pragma once

#include <impactdic/device.h>

#include <mutex>
#include <string>

#include "host/view/measure_frame.h"
#include "host/view/page_request.h"
#include "host/view/run_job.h"
#include "host/view/target.h"

namespace impactdic::view {

class Answers {
 public:
  // All must outlive it.
  Answers(Target& target, Session& session, RunJob& run)
      : target_(target), session_(session), run_(run), measurer_(session) {}
  // Called from several threads at once. Throws what Server makes an answer of.
  PageAnswer operator()(const PageRequest& request);

 private:
  PageAnswer state(const PageRequest& request);
  PageAnswer picture(const PageRequest& request);
  PageAnswer file(const PageRequest& request);
  PageAnswer field(const PageRequest& request);
  PageAnswer history(const PageRequest& request);
  PageAnswer film(const PageRequest& request);
  PageAnswer change(const PageRequest& request);
  PageAnswer describe_job(const TrackJob& job) const;

  Target& target_;
  Session& session_;
  RunJob& run_;
  FrameMeasurer measurer_;
  std::mutex filming_;  // one film at a time: each takes all cores
};

}  // namespace impactdic::view
