#include "host/video/live/frame_queue.h"

#include <algorithm>
#include <utility>

namespace impactdic::video {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point after(Clock::time_point begin, std::chrono::duration<double> wait) {
  return begin + std::chrono::duration_cast<Clock::duration>(wait);
}

}  // namespace

FrameQueue::FrameQueue(std::size_t capacity, bool holds_back)
    : capacity_(std::max<std::size_t>(capacity, 1)), holds_back_(holds_back) {}

void FrameQueue::push(Frame frame) {
  const auto now = Clock::now();
  {
    std::unique_lock<std::mutex> lock(mutex_);
    if (holds_back_) went_.wait(lock, [&] { return abandoned_ || waiting_.size() < capacity_; });
    if (abandoned_) return;
    while (waiting_.size() >= capacity_) {
      spare_.push_back(std::move(waiting_.front().frame));
      waiting_.pop_front();
      ++dropped_;
    }
    waiting_.push_back({std::move(frame), next_++, now});
  }
  came_.notify_one();
}

void FrameQueue::limit(std::size_t capacity) {
  const std::lock_guard<std::mutex> lock(mutex_);
  capacity_ = std::max<std::size_t>(capacity, 1);
}

void FrameQueue::close(std::exception_ptr error) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    error_ = std::move(error);
  }
  came_.notify_one();
}

void FrameQueue::abandon() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    abandoned_ = true;
  }
  went_.notify_one();
}

Frame FrameQueue::spare() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (spare_.empty()) return {};
  Frame frame = std::move(spare_.back());
  spare_.pop_back();
  return frame;
}

void FrameQueue::give_back(Frame frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (spare_.size() < capacity_) spare_.push_back(std::move(frame));
}

std::vector<ArrivedFrame> FrameQueue::pop(std::size_t count, std::chrono::duration<double> wait,
                                          std::chrono::duration<double> patience) {
  std::vector<ArrivedFrame> taken;
  std::unique_lock<std::mutex> lock(mutex_);
  const std::size_t enough = std::min(count, capacity_);
  const auto give_up = after(Clock::now(), patience);
  const auto ready = [&] { return closed_ || waiting_.size() >= enough; };
  while (!ready()) {
    const bool any = !waiting_.empty();
    if (any && wait.count() > 0 && Clock::now() >= after(waiting_.front().at, wait)) break;
    if (Clock::now() >= give_up && (!any || wait.count() <= 0)) return taken;
    const auto until = any && wait.count() > 0 ? after(waiting_.front().at, wait) : give_up;
    came_.wait_until(lock, until);
  }
  while (!waiting_.empty() && taken.size() < count) {
    taken.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
  }
  const bool is_end = taken.empty() && closed_;
  const std::exception_ptr error = is_end ? std::exchange(error_, nullptr) : nullptr;
  lock.unlock();
  went_.notify_one();
  if (error) std::rethrow_exception(error);
  return taken;
}

bool FrameQueue::is_over() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return closed_ && waiting_.empty() && !error_;
}

std::int64_t FrameQueue::dropped() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_;
}

}  // namespace impactdic::video
