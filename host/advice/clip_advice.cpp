#include "host/advice/clip_advice.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <utility>

#include "host/advice/frames/frame_checks.h"
#include "host/advice/looks.h"
#include "host/advice/reflex.h"
#include "host/base/statistics.h"

namespace impactdic::advice {
namespace {

template <typename... Values>
std::string say(const char* format, Values... values) {
  char text[320];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// The largest of the figures that `part` picks out.
std::optional<double> largest(const std::vector<Look>& looks, std::optional<double> Look::*part) {
  std::optional<double> most;
  for (const Look& look : looks) {
    if (look.*part && (!most || *(look.*part) > *most)) most = look.*part;
  }
  return most;
}

template <typename Test>
int count_of(const std::vector<Look>& looks, const Test& test) {
  return static_cast<int>(std::count_if(looks.begin(), looks.end(), test));
}

void warn_of_light(const std::vector<Look>& looks, std::vector<std::string>& warnings) {
  constexpr double kSaturated = 0.01, kBlurredPx = 4.5;
  const int all = static_cast<int>(looks.size());
  const int over = count_of(looks, [](const Look& l) { return l.saturated > kSaturated; });
  if (over > 0) {
    double most = 0;
    for (const Look& look : looks) most = std::max(most, look.saturated);
    warnings.push_back(
        say("%d %% of the frames looked at are over-exposed, up to %.0f %% of their "
            "pixels at the highest level: less light or a shorter exposure",
            100 * over / all, 100 * most));
  }
  const int soft =
      count_of(looks, [](const Look& l) { return l.edge_px && *l.edge_px > kBlurredPx; });
  if (soft > 0) {
    warnings.push_back(
        say("%d %% of the frames looked at are blurred, the ball's edge up to %.1f "
            "px wide (a sharp one has 2): focus, or a shorter exposure",
            100 * soft / all, *largest(looks, &Look::edge_px)));
  }
  const int woven = count_of(looks, [](const Look& l) { return l.interlaced; });
  if (2 * woven > all) {
    warnings.push_back(
        "the frames are interlaced, every other row of another time: de-interlace the clip into "
        "its fields, or film progressively");
  }
  const int repeating = count_of(looks, [](const Look& l) { return l.repeats_pixels; });
  if (2 * repeating > all) {
    warnings.push_back(
        "every pixel is shown more than once: the pictures were enlarged, and motions are wrong by "
        "more than they state; give the film as it was recorded");
  }
}

// Of what a recorder or a converter makes of pictures.
void warn_of_memory(const std::vector<Look>& looks, std::vector<std::string>& warnings) {
  constexpr double kLeast = 0.06, kSds = 6;
  constexpr double kMost = 0.7;  // what moves slowly, or light, makes more
  std::vector<double> shares;
  for (const Look& look : looks) {
    if (!look.memory) continue;
    const bool plain =
        look.memory->share > std::max(kLeast, kSds * look.memory->sd) && look.memory->share < kMost;
    if (plain) shares.push_back(look.memory->share);
  }
  if (shares.empty() || 2 * shares.size() <= looks.size()) return;
  warnings.push_back(say(
      "about %.0f %% of each picture is that of the one before, by their noise, as a recorder's "
      "noise reduction makes it: the ball seems to lag behind, and motions are wrong by more "
      "than they state; switch it off",
      100 * upper_median(std::move(shares))));
}

void warn_of_motion(const AdviceRequest& request, const ClipAdvice& advice,
                    const std::vector<Look>& looks, std::vector<std::string>& warnings) {
  constexpr int kMostSearchPx = 128, kSpare = 2;
  const int search = request.field.search_px;
  if (const auto shift = largest(looks, &Look::shift_px); shift && *shift > search) {
    const int enough = static_cast<int>(std::ceil(*shift)) + kSpare;
    warnings.push_back(
        say("the region moves by about %.0f px a frame, farther than --search %d "
            "looks: --search %d would do",
            *shift, search, enough));
  }
  // The whole ball and rings are found at any turn.
  if (!advice.turn_deg || !advice.ball || request.estimator != Estimator::kField) return;
  const double rim = advice.ball->r_px - request.rim_margin_px - request.field.window_px / 2.0;
  const double move = 2 * rim * std::sin(*advice.turn_deg * kRadPerDeg / 2);
  if (move <= search) return;
  const int enough = static_cast<int>(std::ceil(move)) + kSpare;
  const std::string turn =
      say("the ball turns by about %.1f deg a frame: windows at its rim move %.0f px, farther than "
          "--search %d looks: ",
          *advice.turn_deg, move, search);
  warnings.push_back(turn + (enough <= kMostSearchPx
                                 ? say("--search %d would do, or --estimator ring", enough)
                                 : "--estimator ring takes any turn"));
}

void warn_of_texture(const AdviceRequest& request, const TextureAdvice& texture,
                     std::vector<std::string>& warnings) {
  constexpr double kEnough = 0.5;
  if (texture.asked.windows == 0 || texture.asked.usable_share() >= kEnough) return;
  std::string hint;
  for (const SizeAdvice& size : texture.sizes) {
    if (size.window_px > request.field.window_px && size.usable_share() >= 0.9) {
      hint = say("--window %d would do (%.0f %% usable), and ", size.window_px,
                 100 * size.usable_share());
      break;
    }
  }
  warnings.push_back(say("only %.0f %% of the %d-px windows have texture enough: ",
                         100 * texture.asked.usable_share(), texture.asked.window_px) +
                     hint + kBetterPattern);
}

// Whether all squares at these places, as shares of what lies between the picture's sides, are full
// of texture, and of as much contrast as the picture has: where there is no background, there is no
// rim either. Noise that is alike in pixels that touch (a colour camera's) looks like a faint one.
bool is_textured_at(const Frame& frame, const FieldOptions& field,
                    std::initializer_list<std::pair<double, double>> places) {
  constexpr double kAllOver = 0.9, kOfPicture = 0.1;
  const int side = std::max(field.window_px, std::min(frame.width(), frame.height()) / 5);
  if (side > std::min(frame.width(), frame.height())) return false;
  TextureRequest request;
  request.window_px = field.window_px;
  request.min_texture = field.min_texture;
  request.max_sd_px = field.max_sd_px;
  request.asked_alone = true;
  const double least = kOfPicture * contrast_of(frame);
  return std::all_of(places.begin(), places.end(), [&](const auto& place) {
    request.region = {static_cast<int>(place.first * (frame.width() - side)),
                      static_cast<int>(place.second * (frame.height() - side)), side, side};
    const SizeAdvice texture = advise_texture(frame, request).asked;
    return texture.usable_share() >= kAllOver && texture.contrast > least;
  });
}

bool fills_the_picture(const Frame& frame, const FieldOptions& field, bool ball_found) {
  // In a smaller picture one window reaches from its edge to the rim of a large ball.
  constexpr int kLeastWindows = 10;
  if (is_textured_at(frame, field, {{0, 0}, {1, 0}, {0, 1}, {1, 1}})) return true;
  if (std::min(frame.width(), frame.height()) < kLeastWindows * field.window_px) return false;
  return !ball_found && (is_textured_at(frame, field, {{0, 0.5}, {0.5, 0.5}, {1, 0.5}}) ||
                         is_textured_at(frame, field, {{0.5, 0}, {0.5, 0.5}, {0.5, 1}}));
}

void warn_of_size(const AdviceRequest& request, const ClipAdvice& advice,
                  const std::vector<Look>& looks, std::vector<std::string>& warnings) {
  if (!request.ball || looks.empty()) return;
  const Roi& roi = request.roi;
  if (advice.ball && 2 * advice.ball->r_px > std::min(roi.width, roi.height)) {
    warnings.push_back(
        say("the ball (%.0f px across) is larger than the picture (%d x %d px): its "
            "circle is doubtful; film from farther away",
            2 * advice.ball->r_px, roi.width, roi.height));
  }
  if (fills_the_picture(looks.front().first, request.field, advice.frames_with_ball > 0)) {
    warnings.push_back(
        "the picture has texture from side to side: is the ball larger than the picture? Film "
        "from farther away, or measure the surface with impactdic correlate");
  } else if (advice.frames_with_ball == 0) {
    warnings.push_back(
        say("no ball was found in the %d frames looked at: --radius-px LO:HI says "
            "how large it is, --frames where to look",
            advice.frames));
  }
}

}  // namespace

const char* const kBetterPattern =
    "paint a finer pattern: by impactdic study, speckles of 4 to 20 px area over a sixth to a half "
    "of the surface (a2, f1, e1)";

bool is_texture_alone(const Frame& frame, const FieldOptions& field) {
  return fills_the_picture(frame, field, false);
}

ClipAdvice advise_clip(FrameSource& source, const AdviceRequest& request,
                       std::vector<BallPair>* pairs) {
  std::vector<Look> looks = look_around(source, request);
  ClipAdvice advice;
  advice.frames = static_cast<int>(looks.size());
  advice.frames_with_ball = count_of(looks, [](const Look& l) { return l.first_ball.has_value(); });
  advice.edge_px = largest(looks, &Look::edge_px);
  advice.turn_deg = largest(looks, &Look::turn_deg);
  // The middle of those with something to judge.
  std::vector<const Look*> judged;
  for (const Look& look : looks) {
    if (!request.ball || look.first_ball) judged.push_back(&look);
  }
  warn_of_light(looks, advice.warnings);
  warn_of_memory(looks, advice.warnings);
  if (!judged.empty()) {
    const Look& look = *judged[judged.size() / 2];
    TextureRequest texture;
    texture.window_px = request.field.window_px;
    texture.min_texture = request.field.min_texture;
    texture.max_sd_px = request.field.max_sd_px;
    texture.rim_margin_px = request.rim_margin_px;
    texture.circle = look.first_ball;
    texture.region = {0, 0, look.first.width(), look.first.height()};
    advice.texture = advise_texture(look.first, texture);
    advice.ball = look.first_ball;
    if (advice.ball) {
      advice.ball->cx_px += request.roi.x;
      advice.ball->cy_px += request.roi.y;
    }
    std::vector<BallView> views;
    for (const Look& one : looks) {
      if (one.first_ball) views.push_back({&one.first, *one.first_ball});
      if (one.second_ball) views.push_back({&one.second, *one.second_ball});
    }
    advice.reflex_alone = is_reflex_alone(views, advice.texture->noise);
    if (request.with_field && advice.reflex_alone) advice.warnings.emplace_back(kReflexAlone);
    if (request.with_field) warn_of_texture(request, *advice.texture, advice.warnings);
  }
  warn_of_size(request, advice, looks, advice.warnings);
  if (request.with_field) warn_of_motion(request, advice, looks, advice.warnings);
  if (pairs != nullptr) {
    for (Look& look : looks) {
      if (!look.second_ball) continue;
      pairs->push_back({look.index, std::move(look.first), std::move(look.second), *look.first_ball,
                        *look.second_ball});
    }
  }
  return advice;
}

}  // namespace impactdic::advice
