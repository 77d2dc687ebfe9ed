// Containers and pictures in a process of their own: the same frames, few rights, and no harm where
// it ends.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/safety/sandbox.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "host/video/codec_module.h"
#include "host/video/sandbox/confine.h"
#include "tests/support/video.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;
using testing::random_frame;
using testing::same_pixels;
using testing::ScratchFolder;

constexpr int kWidth = 40, kHeight = 24, kFrames = 50;

std::string write_avi(const ScratchFolder& folder) {
  const std::string path = folder.file("a.avi");
  ClipInfo info;
  info.width = kWidth;
  info.height = kHeight;
  info.fps = 1000;
  const auto sink = video::codec_module(path, "").open_sink(path, video::SinkFormat::kAvi, info);
  for (int i = 0; i < kFrames; ++i) sink->write(random_frame(kWidth, kHeight, 8, 100u + i));
  sink->finish();
  return path;
}

// Of this process, those of the program that decodes.
std::vector<pid_t> decoders() {
  std::vector<pid_t> found;
  for (const auto& task : fs::directory_iterator("/proc/self/task")) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;) found.push_back(child);
  }
  return found;
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(Sandbox, GivesWhatTheCodecsGiveInAnyOrder) {
  const ScratchFolder folder;
  const std::string path = write_avi(folder);
  const auto inside = video::codec_module(path, "").open(path, {});
  const auto clip = video::open_video({path});
  ASSERT_EQ(decoders().size(), 1u);
  EXPECT_EQ(clip->info().frame_count, kFrames);
  EXPECT_EQ(clip->info().format, inside->info().format);
  EXPECT_EQ(clip->info().storage, inside->info().storage);
  EXPECT_EQ(clip->info().fps, inside->info().fps);
  EXPECT_EQ(clip->info().warnings, inside->info().warnings);
  Frame frame;
  for (const int k : {0, 1, 2, 3, 9, 8, 7, 30, 31, 29, 0, 49, 48, 49, 12}) {
    clip->read(k, frame);
    EXPECT_TRUE(same_pixels(frame, random_frame(kWidth, kHeight, 8, 100u + k))) << k;
  }
  EXPECT_THROW(clip->read(kFrames, frame), InvalidArgument);
}

TEST(Sandbox, ThreadsShareAClip) {
  const ScratchFolder folder;
  const auto clip = video::open_video({write_avi(folder)});
  std::atomic<int> next = 0, wrong = 0;
  const auto work = [&] {
    Frame frame;
    for (int k = next++; k < kFrames; k = next++) {
      clip->read(k, frame);
      wrong += !same_pixels(frame, random_frame(kWidth, kHeight, 8, 100u + k));
    }
  };
  std::thread first(work), second(work);
  work();
  first.join();
  second.join();
  EXPECT_EQ(wrong, 0);
}

TEST(Sandbox, TheProcessHasFewRightsAndEndsWithItsClip) {
  const ScratchFolder folder;
  const std::ofstream secret(folder.file("secret"));
  auto clip = video::open_video({write_avi(folder)});
  const auto running = decoders();
  ASSERT_EQ(running.size(), 1u);
  const fs::path process = "/proc/" + std::to_string(running.front());
  EXPECT_NE(text_of(process / "limits").find("Max file size             0 "), std::string::npos);
  EXPECT_NE(text_of(process / "limits").find("Max open files            64 "), std::string::npos);
  const std::string status = text_of(process / "status");
  EXPECT_NE(status.find("NoNewPrivs:\t1"), std::string::npos);
  EXPECT_EQ(status.find("Seccomp:\t0"), std::string::npos) << status;
  for (const auto& entry : fs::directory_iterator(process / "fd")) {
    std::error_code gone;
    EXPECT_NE(fs::read_symlink(entry.path(), gone).filename(), "secret");
  }
  clip.reset();
  EXPECT_TRUE(decoders().empty());
  EXPECT_FALSE(fs::exists(process));
}

// In a process of its own: what it can do once it is confined to `clip`, a letter each.
std::string what_is_left(const std::string& clip, const std::string& other) {
  int pipe[2];
  if (::pipe(pipe) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    const video::sandbox::Confined taken = video::sandbox::confine({clip, clip + ".not there"});
    std::string can;
    const auto try_it = [&](char letter, bool works) {
      if (works) can += letter;
    };
    try_it('c', ::open(clip.c_str(), O_RDONLY) >= 0);
    std::thread([&] { try_it('t', true); }).join();
    try_it('a', ::syscall(SYS_tgkill, ::getpid(), ::getpid(), 0) == 0);
    if (!taken.files) can += '1';
    try_it('f', taken.files && ::open(other.c_str(), O_RDONLY) >= 0);
    try_it('w', taken.files && ::open(clip.c_str(), O_WRONLY) >= 0);
    try_it('d', taken.files && ::open("/", O_RDONLY | O_DIRECTORY) >= 0);
    if (!taken.network) can += '2';
    for (const int family : {AF_INET, AF_INET6, AF_UNIX, AF_NETLINK}) {
      try_it('n', taken.network && ::socket(family, SOCK_DGRAM, 0) >= 0);
    }
    try_it('k', taken.network && ::kill(::getppid(), 0) == 0);
    try_it('s', taken.network && ::syscall(SYS_tgkill, ::getppid(), ::getppid(), 0) == 0);
    if (taken.network) {
      const pid_t born = ::fork();
      if (born == 0) ::_exit(0);
      try_it('p', born > 0);
      ::execl("/bin/true", "true", nullptr);  // would end without a word
    }
    ::_exit(::write(pipe[1], can.data(), can.size()) < 0 ? 1 : 0);
  }
  ::close(pipe[1]);
  char told[64];
  const ssize_t count = ::read(pipe[0], told, sizeof told);
  ::close(pipe[0]);
  ::waitpid(child, nullptr, 0);
  return count < 0 ? "nothing" : std::string(told, static_cast<std::size_t>(count));
}

TEST(Sandbox, ConfinedThereIsTheClipAndNothingElse) {
  const ScratchFolder folder;
  const std::string clip = write_avi(folder);
  std::ofstream(folder.file("other")) << "secret";
  std::string left = what_is_left(clip, folder.file("other"));
  // Kernels that know neither: nothing is taken, and nothing fails.
  std::erase(left, '1');
  std::erase(left, '2');
  EXPECT_EQ(left, "cta");
  EXPECT_EQ(what_is_left(folder.file("none"), clip).find_first_of("nksp"), std::string::npos);
}

TEST(Sandbox, AProcessThatEndsIsAnErrorOfItsFile) {
  const ScratchFolder folder;
  const auto clip = video::open_video({write_avi(folder)});
  Frame frame;
  clip->read(0, frame);
  for (const pid_t child : decoders()) ::kill(child, SIGABRT);  // which no sanitizer catches
  const auto began = std::chrono::steady_clock::now();
  try {
    // What was decoded ahead may still come.
    for (int k = 1; k < kFrames; ++k) clip->read(k, frame);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const FormatError& error) {
    EXPECT_NE(error.line().find("a.avi"), std::string::npos) << error.line();
    EXPECT_NE(error.line().find("signal 6"), std::string::npos) << error.line();
  }
  EXPECT_THROW(clip->read(5, frame), FormatError);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(30));
}

TEST(Sandbox, ErrorsAreThoseOfTheCodecs) {
  const ScratchFolder folder;
  const std::string path = write_avi(folder);
  OpenOptions small;
  small.max_megapixels = 0.0005;
  EXPECT_THROW(video::open_video({path}, small), FormatError);
  auto bytes = testing::file_bytes(path);
  std::fill(bytes.begin() + 100, bytes.end(), '\x5a');
  testing::write_bytes(folder / "a.avi", bytes);
  const auto line = [&](const auto& open) -> std::string {
    try {
      open();
      return "";
    } catch (const FormatError& error) {
      return error.line();
    }
  };
  const std::string inside = line([&] { video::codec_module(path, "").open(path, {}); });
  EXPECT_NE(inside, "");
  EXPECT_EQ(line([&] { video::open_video({path}); }), inside);
  EXPECT_TRUE(decoders().empty());
}

// Seven pictures in a folder, the last a TIFF.
std::vector<std::string> write_pictures(const ScratchFolder& folder, int bits = 16) {
  ClipInfo info;
  info.width = kWidth;
  info.height = kHeight;
  info.bits = bits;
  const std::string pngs = folder.file("pngs"), tif = folder.file("pngs/last.tif");
  const auto sink = video::codec_module(pngs, "").open_sink(pngs, video::SinkFormat::kPng, info);
  for (int i = 0; i < 6; ++i) sink->write(random_frame(kWidth, kHeight, bits, 200u + i));
  sink->finish();
  const auto last = video::open_sink(tif, video::SinkFormat::kTiff, info);
  last->write(random_frame(kWidth, kHeight, bits, 206u));
  last->finish();
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(pngs)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

class PictureSandbox : public ::testing::Test {
 protected:
  void SetUp() override { set_picture_sandbox(true); }
  void TearDown() override { set_picture_sandbox(false); }
};

TEST_F(PictureSandbox, GivesWhatTheCodecsGive) {
  const ScratchFolder folder, grey;
  const auto paths = write_pictures(folder);
  const std::vector<std::vector<std::string>> sequences = {
      paths, {paths[2]}, {paths[0], paths[3], paths[6]}, write_pictures(grey, 8)};
  for (const auto& some : sequences) {
    set_picture_sandbox(false);
    const auto inside = video::open_video(some);
    EXPECT_TRUE(decoders().empty()) << "pictures are decoded here unless it is asked for";
    set_picture_sandbox(true);
    const auto clip = video::open_video(some);
    ASSERT_EQ(decoders().size(), 1u);
    const ClipInfo &is = clip->info(), &asked = inside->info();
    EXPECT_EQ(is.path, asked.path);
    EXPECT_EQ(is.files, asked.files);
    EXPECT_EQ(is.format, asked.format);
    EXPECT_EQ(is.storage, asked.storage);
    EXPECT_EQ(is.bits, asked.bits);
    EXPECT_EQ(is.frame_count, asked.frame_count);
    EXPECT_EQ(is.warnings, asked.warnings);
    EXPECT_EQ(is.extra, asked.extra);
    Frame frame, same;
    for (auto k = is.frame_count - 1; k >= 0; --k) {
      clip->read(k, frame);
      inside->read(k, same);
      EXPECT_TRUE(same_pixels(frame, same)) << k;
    }
  }
}

TEST_F(PictureSandbox, ADamagedPictureIsNamedAndNoOther) {
  const ScratchFolder folder;
  const auto paths = write_pictures(folder);
  auto bytes = testing::file_bytes(paths[4]);
  bytes.resize(bytes.size() / 2);
  testing::write_bytes(paths[4], bytes);
  const auto clip = video::open_video(paths);
  Frame frame;
  for (const int k : {3, 4, 5}) {
    try {
      clip->read(k, frame);
      EXPECT_NE(k, 4);
      EXPECT_TRUE(same_pixels(frame, random_frame(kWidth, kHeight, 16, 200u + k))) << k;
    } catch (const FormatError& error) {
      EXPECT_EQ(k, 4);
      EXPECT_NE(error.line().find(fs::path(paths[4]).filename()), std::string::npos);
    }
  }
}

TEST_F(PictureSandbox, ManyPicturesAreToldInSeveralMessages) {
  const ScratchFolder folder;
  std::vector<std::string> paths(3000, write_pictures(folder)[1]);
  paths.back() = folder.file("pngs/last.tif");
  const auto clip = video::open_video(paths);
  Frame frame;
  clip->read(2998, frame);
  EXPECT_TRUE(same_pixels(frame, random_frame(kWidth, kHeight, 16, 201u)));
  clip->read(2999, frame);
  EXPECT_TRUE(same_pixels(frame, random_frame(kWidth, kHeight, 16, 206u)));
}

std::string write_stack(const ScratchFolder& folder, int pages) {
  const std::string path = folder.file("stack.tif");
  ClipInfo info;
  info.width = kWidth;
  info.height = kHeight;
  info.bits = 12;
  info.fps = 10000;
  const auto sink = video::open_sink(path, video::SinkFormat::kTiff, info);
  for (int i = 0; i < pages; ++i) sink->write(random_frame(kWidth, kHeight, 12, 300u + i));
  sink->finish();
  return path;
}

TEST_F(PictureSandbox, GivesThePagesOfATiff) {
  const ScratchFolder folder;
  const std::string path = write_stack(folder, 9);
  set_picture_sandbox(false);
  const auto inside = video::open_video({path});
  EXPECT_TRUE(decoders().empty());
  set_picture_sandbox(true);
  const auto clip = video::open_video({path});
  ASSERT_EQ(decoders().size(), 1u);
  const ClipInfo &is = clip->info(), &asked = inside->info();
  EXPECT_EQ(is.path, asked.path);
  EXPECT_EQ(is.files, asked.files);
  EXPECT_EQ(is.format, asked.format);
  EXPECT_EQ(is.storage, asked.storage);
  EXPECT_EQ(is.bits, 12);
  EXPECT_EQ(is.fps, 10000);
  EXPECT_EQ(is.frame_count, 9);
  EXPECT_EQ(is.extra, asked.extra);
  Frame frame;
  for (const int k : {0, 1, 2, 8, 3, 8, 0}) {
    clip->read(k, frame);
    EXPECT_TRUE(same_pixels(frame, random_frame(kWidth, kHeight, 12, 300u + k))) << k;
  }
  EXPECT_THROW(clip->read(9, frame), InvalidArgument);
}

TEST_F(PictureSandbox, ADamagedOrLargeTiffIsRefusedAsItIsInside) {
  const ScratchFolder folder;
  const std::string path = write_stack(folder, 3);
  const auto line = [&](const OpenOptions& options) -> std::string {
    try {
      video::open_video({path}, options);
      return "";
    } catch (const FormatError& error) {
      return error.line();
    }
  };
  OpenOptions small;
  small.max_megapixels = 0.0005;
  const auto both = [&](const OpenOptions& options) {
    set_picture_sandbox(true);
    const std::string outside = line(options);
    set_picture_sandbox(false);
    EXPECT_EQ(line(options), outside);
    return outside;
  };
  EXPECT_EQ(both({}), "");
  EXPECT_NE(both(small), "");
  auto bytes = testing::file_bytes(path);
  bytes.resize(bytes.size() - 40);  // of the last directory
  testing::write_bytes(path, bytes);
  EXPECT_NE(both({}), "");
}

TEST(Sandbox, CanBeLeftOut) {
  const ScratchFolder folder;
  const std::string path = write_avi(folder);
  set_sandbox(false);
  const auto clip = video::open_video({path});
  set_sandbox(true);
  EXPECT_TRUE(decoders().empty());
  Frame frame;
  clip->read(7, frame);
  EXPECT_TRUE(same_pixels(frame, random_frame(kWidth, kHeight, 8, 107u)));
}

}  // namespace
}  // namespace impactdic
