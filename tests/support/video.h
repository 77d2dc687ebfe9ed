// Small clips for the tests of readers and writers, and a folder of their own for each test.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "host/video/frame_sink.h"
#include "host/video/frame_source.h"
#include "tests/support/scratch.h"

namespace impactdic::testing {

// Random pixels over the whole range of `bits`, the same for the same seed.
inline Frame random_frame(int width, int height, int bits, std::uint32_t seed) {
  std::mt19937 random(seed);
  Frame frame;
  frame.reset(width, height, bits);
  const std::uint32_t mask = (1u << bits) - 1;
  for (std::size_t i = 0; i < frame.u8.size(); ++i) {
    frame.u8.data()[i] = static_cast<std::uint8_t>(random() & mask);
  }
  for (std::size_t i = 0; i < frame.u16.size(); ++i) {
    frame.u16.data()[i] = static_cast<std::uint16_t>(random() & mask);
  }
  return frame;
}

inline bool same_pixels(const Frame& a, const Frame& b) {
  if (a.type != b.type || a.width() != b.width() || a.height() != b.height()) return false;
  return std::equal(static_cast<const std::uint8_t*>(a.bytes()),
                    static_cast<const std::uint8_t*>(a.bytes()) + a.byte_count(),
                    static_cast<const std::uint8_t*>(b.bytes()));
}

inline std::vector<char> file_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void write_bytes(const std::filesystem::path& path, const char* bytes, std::size_t count) {
  std::ofstream(path, std::ios::binary).write(bytes, static_cast<std::streamsize>(count));
}
inline void write_bytes(const std::filesystem::path& path, const std::vector<char>& bytes) {
  write_bytes(path, bytes.data(), bytes.size());
}

}  // namespace impactdic::testing
