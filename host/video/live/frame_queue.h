// Frames between a camera, which does not wait, and whoever measures them.
#pragma once

#include <impactdic/image.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <vector>

namespace impactdic::video {

struct ArrivedFrame {
  Frame frame;
  std::int64_t number = 0;  // of all frames that came
  std::chrono::steady_clock::time_point at;
};

// For one thread that puts frames in and one that takes them out.
class FrameQueue {
 public:
  // At most `capacity` frames wait. Where it is full the oldest is dropped, or, if it `holds_back`,
  // `push` waits.
  FrameQueue(std::size_t capacity, bool holds_back);

  void push(Frame frame);
  void limit(std::size_t capacity);  // from here on
  // No frame comes any more; `error`, where there is one, comes out of `pop` after the last frame.
  void close(std::exception_ptr error = nullptr);
  // Nobody takes frames any more: `push` drops them.
  void abandon();
  // A frame whose memory is to be used again.
  Frame spare();
  void give_back(Frame frame);

  // Up to `count` consecutive frames: as soon as there are so many, or the first of them has waited
  // for `wait` (0: for ever), or the stream has ended. Empty at the end, or when `patience` is over
  // and no frame has come.
  std::vector<ArrivedFrame> pop(std::size_t count, std::chrono::duration<double> wait,
                                std::chrono::duration<double> patience);
  bool is_over();
  std::int64_t dropped();

 private:
  std::size_t capacity_;
  bool holds_back_;
  std::mutex mutex_;
  std::condition_variable came_, went_;
  std::deque<ArrivedFrame> waiting_;
  std::vector<Frame> spare_;
  std::int64_t next_ = 0, dropped_ = 0;
  bool closed_ = false, abandoned_ = false;
  std::exception_ptr error_;
};

}  // namespace impactdic::video
