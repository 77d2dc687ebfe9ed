#include "host/dic/window_correlator.h"

#include <algorithm>
#include <cmath>

#include "host/dic/device/tuning.h"
#include "host/dic/reference/zncc.h"
#include "host/dic/seed_options.h"

namespace impactdic::dic {
namespace {

// Pictures are cut about a clip's ball: not another program for every width, for a few per cent.
ZnccVariant variant_of(const opencl::Engine& engine, const FieldOptions& seed) {
  ZnccVariant variant = choose_zncc_variant(engine, seed);
  variant.width_known = false;
  return variant;
}

}  // namespace

std::vector<opencl::ProgramRequest> WindowCorrelator::programs(const opencl::Engine& engine,
                                                               const FieldOptions& options,
                                                               PixelType type) {
  if (options.method != FieldMethod::kZncc && options.method != FieldMethod::kIcgn) return {};
  const FieldOptions seed = seed_options(options);
  ZnccVariant variant = variant_of(engine, seed);
  if (variant.path == ZnccPath::kBytes && type != PixelType::kU8) return {};
  auto all = ZnccOpencl::programs(engine, seed, variant, type, 0);
  if (options.method == FieldMethod::kIcgn) {
    all.insert(all.begin() + 1, IcgnRefiner::program(engine, options));
    all.insert(all.begin() + 2, SplineFrames::program(engine, options.spline_degree, 0.0));
  }
  return all;
}

WindowCorrelator::WindowCorrelator(opencl::Engine& engine, const FieldOptions& options, int slots)
    : engine_(engine), window_px_(options.window_px), discs_(slots) {
  options.validate();
  if (options.method == FieldMethod::kPublished) {
    published_.emplace(engine, options);
  } else if (options.method == FieldMethod::kEqual) {
    // Which pictures follow each other is not known here.
    EqualVariant variant = choose_equal_variant(engine, options.window_px, false);
    variant.width_known = false;
    equal_.emplace(engine, options, variant);
  } else {
    const FieldOptions seed = seed_options(options);
    zncc_.emplace(engine, seed, variant_of(engine, seed));
  }
  if (options.method == FieldMethod::kIcgn) icgn_.emplace(engine, options, slots);
}

void WindowCorrelator::check_frames(const DeviceFrames& frames,
                                    std::span<const Window> windows) const {
  // A pair's windows follow each other.
  const Window* before = nullptr;
  for (const Window& window : windows) {
    const bool known =
        before != nullptr && window.first == before->first && window.second == before->second;
    before = &window;
    if (known) continue;
    if (frames.version(window.first) == 0 || frames.version(window.second) == 0) {
      throw InvalidArgument("a window names a frame slot which holds no frame");
    }
  }
}

const std::vector<WindowMotion>& WindowCorrelator::find(DeviceFrames& frames,
                                                        std::span<const Window> windows) {
  check_frames(frames, windows);
  results_.resize(windows.size());
  if (!icgn_) {
    search(frames, windows, results_, false);
    return results_;
  }
  whole_.search(windows, window_px_, discs_, WindowStatus::kMasked, results_,
                [&](std::span<const Window> whole, std::span<WindowMotion> found) {
                  search(frames, whole, found, false);
                });
  return results_;
}

const std::vector<WindowMotion>& WindowCorrelator::correlate(DeviceFrames& frames,
                                                             std::span<const Window> windows) {
  if (!icgn_) return find(frames, windows);
  check_frames(frames, windows);
  results_.resize(windows.size());
  whole_.search(windows, window_px_, discs_, WindowStatus::kLowCorrelation, results_,
                [&](std::span<const Window> whole, std::span<WindowMotion> found) {
                  search(frames, whole, found, true);
                });
  const RefineWindows again = refining(frames);
  neighbours_.refine_lost(windows, window_px_, again, results_);
  // The others were judged when they were searched.
  neighbours_.judge_lost(windows, whole_.cut(), again, results_);
  return results_;
}

const std::vector<WindowMotion>& WindowCorrelator::follow(DeviceFrames& frames,
                                                          std::span<const Window> windows,
                                                          std::span<const WindowMotion> seeds) {
  if (!icgn_) return find(frames, windows);
  if (seeds.size() != windows.size()) throw InvalidArgument("every window needs a seed");
  check_frames(frames, windows);
  results_.resize(windows.size());
  refine(frames, windows, seeds, results_);
  search_lost(frames, windows);
  // IC-GN has judged the texture of all of them.
  neighbours_.refine_lost(windows, window_px_, refining(frames), results_);
  return results_;
}

void WindowCorrelator::search_lost(DeviceFrames& frames, std::span<const Window> windows) {
  lost_.clear();
  lost_windows_.clear();
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (!is_lost(results_[i]) || discs_.cuts(windows[i], window_px_)) continue;
    lost_.push_back(i);
    lost_windows_.push_back(windows[i]);
  }
  found_.resize(lost_.size());
  search(frames, lost_windows_, found_, true);
  for (std::size_t k = 0; k < lost_.size(); ++k) results_[lost_[k]] = found_[k];
}

RefineWindows WindowCorrelator::refining(DeviceFrames& frames) {
  return [this, &frames](std::span<const Window> windows, std::span<const WindowMotion> seeds,
                         std::span<WindowMotion> found) { refine(frames, windows, seeds, found); };
}

void WindowCorrelator::set_disc(int slot, double cx_px, double cy_px, double radius_px) {
  discs_.set(slot, cx_px, cy_px, radius_px);
  if (icgn_) icgn_->set_disc(slot, cx_px, cy_px, radius_px);
}

void WindowCorrelator::search(DeviceFrames& frames, std::span<const Window> windows,
                              std::span<WindowMotion> motions, bool refined) {
  if (windows.empty()) return;
  if (equal_ && std::min(frames.width(), frames.height()) < window_px_) {
    std::ranges::fill(motions, without_motion(WindowStatus::kOutOfView, std::nan("")));
    return;
  }
  const std::size_t most = at_once(windows.size());
  windows_.reserve(engine_, most);
  motions_.reserve(engine_, most);
  for (std::size_t first = 0; first < windows.size(); first += most) {
    const auto some = windows.subspan(first, std::min(most, windows.size() - first));
    opencl::Settled settled(engine_);
    windows_.write_later(engine_, some);
    if (published_) published_->run(frames, windows_, some.size(), motions_);
    if (equal_) equal_->run(frames, windows_, some.size(), motions_);
    if (zncc_) zncc_->run(frames, windows_, some.size(), motions_);
    if (refined) icgn_->refine(frames, windows_, some.size(), motions_);
    motions_.read(engine_, motions.subspan(first, some.size()));
    settled.done();
  }
}

std::size_t WindowCorrelator::at_once(std::size_t windows) const {
  return engine_.at_once(windows, static_cast<double>(window_px_) * window_px_);
}

void WindowCorrelator::refine(DeviceFrames& frames, std::span<const Window> windows,
                              std::span<const WindowMotion> seeds,
                              std::span<WindowMotion> motions) {
  if (windows.empty()) return;
  const std::size_t most = at_once(windows.size());
  windows_.reserve(engine_, most);
  motions_.reserve(engine_, most);
  for (std::size_t first = 0; first < windows.size(); first += most) {
    const std::size_t count = std::min(most, windows.size() - first);
    opencl::Settled settled(engine_);
    windows_.write_later(engine_, windows.subspan(first, count));
    motions_.write_later(engine_, seeds.subspan(first, count));
    icgn_->refine(frames, windows_, count, motions_);
    motions_.read(engine_, motions.subspan(first, count));
    settled.done();
  }
}

}  // namespace impactdic::dic
