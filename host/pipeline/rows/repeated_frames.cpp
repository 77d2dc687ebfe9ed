#include "host/pipeline/rows/repeated_frames.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "host/clip/surface_step.h"
#include "host/pipeline/rows/fill_row.h"

namespace impactdic::pipeline {
namespace {

// A ball moves plainly that goes so far a step, and by so many deviations, which hold what all
// steps have alike, too. Beside pictures that are the same it takes fewer: no noise made those.
constexpr double kPlain_px = 0.1, kPlainSds = 10, kBesideSameSds = 2;
// It stands that goes no farther, or by no more deviations, and by no more of the steps beside.
constexpr double kStands_px = 0.02, kStandsSds = 5, kStandsOfStep = 0.05;

template <typename T>
bool is_same(ImageView<const T> a, ImageView<const T> b) {
  if (a.width != b.width || a.height != b.height) return false;
  // From the middle on, where the ball may be: a black ground is the same in many pictures.
  for (int k = 0; k < a.height; ++k) {
    const int y = (a.height / 2 + k) % a.height;
    if (!std::equal(a.row(y), a.row(y) + a.width, b.row(y))) return false;
  }
  return true;
}

// Whether two neighbouring rows of some that cross the ball are the same, and show so much that no
// two exposures would.
template <typename T>
bool shares_rows(ImageView<const T> a, ImageView<const T> b, const Circle& ball) {
  constexpr int kRows = 18, kLeastChanges = 16;
  constexpr double kOfRadius = 0.85;
  bool one_before = false;
  for (int k = 0; k < kRows; ++k) {
    const double off = kOfRadius * ball.r_px * (2.0 * k / (kRows - 1) - 1);
    const double half = kOfRadius * std::sqrt(std::max(ball.r_px * ball.r_px - off * off, 0.0));
    const int y = static_cast<int>(std::lround(ball.cy_px + off));
    const int left = std::max(0, static_cast<int>(ball.cx_px - half));
    const int right = std::min(a.width, static_cast<int>(ball.cx_px + half) + 1);
    bool same = y >= 0 && y < a.height && left < right &&
                std::equal(a.row(y) + left, a.row(y) + right, b.row(y) + left);
    if (same) {
      int changes = 0;
      for (int x = left + 1; x < right; ++x) changes += a(x, y) != a(x - 1, y);
      same = changes >= kLeastChanges;
    }
    if (same && one_before) return true;
    one_before = same;
  }
  return false;
}

bool is_torn(const Frame& a, const Frame& b, const Circle& ball) {
  const bool alike = a.type == b.type && a.width() == b.width() && a.height() == b.height();
  if (!alike || !(ball.r_px > 0)) return false;
  return a.type == PixelType::kU8 ? shares_rows(a.u8.view(), b.u8.view(), ball)
                                  : shares_rows(a.u16.view(), b.u16.view(), ball);
}

bool is_plain(const TrackRow& row, double sds = kPlainSds) {
  return SurfaceStep(row).length() > std::max(kPlain_px, sds * SurfaceStep::sd_px(row));
}
bool is_none_beside(const TrackRow& row, const TrackRow& other) {
  const double stands_px = std::max(kStands_px, kStandsSds * SurfaceStep::sd_px(row));
  return SurfaceStep(row).length() <
         std::min(stands_px, kStandsOfStep * SurfaceStep(other).length());
}
bool lead_back(const TrackRow& before, const TrackRow& after) {
  const SurfaceStep a(before), b(after);
  return a.dot(b) < -0.5 * a.length() * b.length();
}

// The nearest rows with a motion that lead to no picture that is the same, on either side of `of`.
struct Beside {
  const TrackRow *before, *after = nullptr;
};
Beside beside(const TrackBatch& batch, std::size_t of, const TrackRow* before_batch) {
  const auto leads = [&](std::size_t i) {
    return batch.rows[i].motion_ok && batch.rows[i].circle_ok && !batch.repeats[i + 1];
  };
  Beside rows{before_batch != nullptr && before_batch->motion_ok ? before_batch : nullptr};
  for (std::size_t i = of; i-- > 0;) {
    if (!leads(i)) continue;
    rows.before = &batch.rows[i];
    break;
  }
  for (std::size_t i = of + 1; i + 1 < batch.rows.size() && rows.after == nullptr; ++i) {
    if (leads(i)) rows.after = &batch.rows[i];
  }
  return rows;
}

// Whether row `from` leads to a frame that repeats its picture.
bool leads_to_repeat(const TrackBatch& batch, std::size_t from, const TrackRow* before_batch) {
  const TrackRow& row = batch.rows[from];
  const bool same = batch.repeats[from + 1];
  if (!row.circle_ok || !(same || row.motion_ok)) return false;
  if (!same && is_plain(row)) return false;  // as nearly all rows do
  const auto [before, after] = beside(batch, from, before_batch);
  if (before == nullptr && after == nullptr) return false;
  for (const TrackRow* other : {before, after}) {
    if (other == nullptr) continue;
    if (!is_plain(*other, same ? kBesideSameSds : kPlainSds)) return false;
    if (!same && !is_none_beside(row, *other)) return false;
  }
  const bool both = before != nullptr && after != nullptr;
  return same || !both || !lead_back(*before, *after);
}

void forget_all(TrackRow& row) {
  TrackRow empty;
  empty.frame = row.frame;
  empty.time_s = row.time_s;
  empty.periods = row.periods;
  empty.status = TrackStatus::kRepeated;
  row = empty;
}

// Of a frame that is left out, and the motions that lead to it and away from it.
void leave_out(TrackBatch& batch, std::size_t frame) {
  forget_all(batch.rows[frame]);
  if (frame < batch.measured.size()) batch.measured[frame] = false;
  if (frame == 0) return;
  TrackRow& row = batch.rows[frame - 1];
  forget_motion(row);
  row.status = TrackStatus::kRepeated;
  if (frame - 1 < batch.measured.size()) batch.measured[frame - 1] = false;
}

}  // namespace

bool is_same_picture(const Frame& a, const Frame& b) {
  if (a.type != b.type) return false;
  return a.type == PixelType::kU8 ? is_same(a.u8.view(), b.u8.view())
                                  : is_same(a.u16.view(), b.u16.view());
}

void note_torn(TrackBatch& batch) {
  for (std::size_t i = 1; i < batch.frames.size(); ++i) {
    if (batch.repeats[i] || !batch.rows[i - 1].circle_ok) continue;
    batch.repeats[i] = is_torn(*batch.frames[i - 1], *batch.frames[i], batch.circles[i - 1]);
  }
}

void leave_out_repeats(TrackBatch& batch, const TrackRow* before, bool first) {
  const std::size_t rows = batch.rows.size();
  std::vector<bool> left_out(rows);
  left_out[0] = first;
  for (std::size_t i = 0; i + 1 < rows; ++i) left_out[i + 1] = leads_to_repeat(batch, i, before);
  for (std::size_t i = 0; i < rows; ++i) {
    if (left_out[i]) leave_out(batch, i);
  }
  batch.repeats = std::move(left_out);
}

}  // namespace impactdic::pipeline
