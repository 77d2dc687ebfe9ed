// One job by the command line, by batch and by the library: the same bytes. A clip from memory: the
// same rows as from its file. Cancelling, noise, errors on the way.
#include <gtest/gtest.h>
#include <impactdic/batch.h>
#include <impactdic/correlate.h>
#include <impactdic/error.h>
#include <impactdic/track.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/pipeline/track_clip.h"
#include "host/report/csv.h"
#include "host/run/session.h"
#include "host/video/frame_sink.h"
#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

namespace fs = std::filesystem;

// Ten frames of a speckled ball with noise, 8 bits, and the same times 16 as a 12-bit file.
class Clip {
 public:
  Clip() {
    const Outcome made = run_program(
        "synth --size 160x160 --radius-px 40 --frames 10 --velocity-px 1,0.5 --rotation-deg 2 "
        "--noise 3 --seed 5 -o " +
        quoted(folder_ / "made"));
    if (made.status != 0) throw std::runtime_error(made.err);
    fs::create_directories(folder_ / "clips");
    fs::rename(folder_ / "made/video.tif", path());
    ClipInfo deep = open_clip({path().string()})->info();
    deep.bits = 12;
    const auto sink = video::open_sink(deep_path().string(), video::SinkFormat::kTiff, deep);
    const auto source = open_clip({path().string()});
    Frame frame;
    for (std::int64_t k = 0; k < source->info().frame_count; ++k) {
      source->read(k, frame);
      Frame out;
      out.reset(frame.width(), frame.height(), 12);
      for (std::size_t i = 0; i < out.u16.size(); ++i) {
        out.u16.data()[i] = static_cast<std::uint16_t>(16 * frame.u8.data()[i]);
      }
      sink->write(out);
    }
    sink->finish();
  }
  fs::path path() const { return folder_ / "clips/shot.tif"; }
  fs::path deep_path() const { return folder_ / "deep.tif"; }
  fs::path out(const std::string& name) const { return folder_ / name; }

 private:
  ScratchFolder folder_;
};

const Clip& clip() {
  static const Clip made;
  return made;
}

Session& session() {
  static Session shared;
  return shared;
}

TrackRequest request_of(const fs::path& path) {
  TrackRequest request;
  request.clip.paths = {path.string()};
  request.clip.fps = 10000;
  request.ball_diameter_mm = 67;
  request.field.window_px = 17;
  return request;
}

bool same_datasets(const fs::path& a, const fs::path& b) {
  const std::string script =
      "import h5py, sys; a, b = map(h5py.File, sys.argv[1:]); "
      "same = lambda k: not isinstance(a[k], h5py.Dataset) or (a[k].shape == b[k].shape and "
      "a[k][()].tobytes() == b[k][()].tobytes()); "
      "sys.exit(set(a) != set(b) or not all(map(same, a)) or dict(a.attrs) != dict(b.attrs))";
  const std::string command = "/usr/bin/python3 -c '" + script + "' " + quoted(a / "fields.h5") +
                              " " + quoted(b / "fields.h5");
  return std::system(command.c_str()) == 0;
}

// Rows as track.csv has them: every figure to the last bit, and the pose.
std::vector<std::string> lines_of(const TrackResult& result) {
  std::vector<std::string> lines;
  for (const TrackRow& row : result.rows) {
    lines.push_back(report::track_csv_line(row, result.scale) + " " +
                    std::to_string(row.pose.angle_rad));
  }
  return lines;
}

TEST(Runs, CommandBatchAndLibraryWriteTheSameBytes) {
  const std::string options = " --fps 10000 --ball-diameter-mm 67 --window 17 -q -o ";
  const fs::path by_command = clip().out("command"), by_library = clip().out("library");
  ASSERT_EQ(run_program("track " + quoted(clip().path()) + options + quoted(by_command)).status, 0);
  TrackFolder folder;
  folder.folder = by_library.string();
  const TrackResult result = track_to_folder(request_of(clip().path()), folder, session());
  BatchRequest shots;
  shots.folder = clip().path().parent_path().string();
  shots.track = request_of("");
  shots.track.clip.paths.clear();
  shots.output.folder = clip().out("batch").string();
  const BatchResult batched = batch(shots, session());
  ASSERT_EQ(batched.failed, 0u);
  ASSERT_EQ(run_program("batch " + quoted(clip().path().parent_path()) + options +
                        quoted(clip().out("batch_command")))
                .status,
            0);
  for (const fs::path& other : {by_library, clip().out("batch") / "shots/shot",
                                clip().out("batch_command") / "shots/shot"}) {
    for (const char* name : {"track.csv", "pose.csv", "job.toml"}) {
      EXPECT_EQ(read_text(by_command / name), read_text(other / name)) << other << " " << name;
    }
    EXPECT_TRUE(same_datasets(by_command, other)) << other;
  }
  EXPECT_EQ(read_text(clip().out("batch") / "shots.csv"),
            read_text(clip().out("batch_command") / "shots.csv"));
  EXPECT_EQ(result.frames_ok, 10);
  // What stands in a finished shot's summary gives the same row of the table.
  const std::string table = read_text(batched.table);
  shots.output.resume = true;
  const BatchResult resumed = batch(shots, session());
  EXPECT_FALSE(resumed.shots.at(0).measured_now);
  EXPECT_EQ(read_text(resumed.table), table);
  // And without any file.
  EXPECT_EQ(lines_of(track(request_of(clip().path()), session())), lines_of(result));
}

// Frames of a file, copied into memory with rows `pitch` bytes apart.
struct InMemory {
  std::vector<std::vector<std::uint8_t>> bytes;
  MemoryClip clip;

  InMemory(const fs::path& path, std::ptrdiff_t gap) {
    const auto source = open_clip({path.string()});
    const ClipInfo& info = source->info();
    const std::ptrdiff_t row = std::ptrdiff_t{info.width} * (info.bits > 8 ? 2 : 1);
    clip.width = info.width;
    clip.height = info.height;
    clip.bits = info.bits;
    clip.pitch_bytes = row + gap;
    Frame frame;
    for (std::int64_t k = 0; k < info.frame_count; ++k) {
      source->read(k, frame);
      auto& to = bytes.emplace_back(static_cast<std::size_t>(clip.pitch_bytes * info.height), 0xaa);
      const auto* from = static_cast<const std::uint8_t*>(frame.bytes());
      for (int y = 0; y < info.height; ++y) {
        std::memcpy(to.data() + y * clip.pitch_bytes, from + y * row,
                    static_cast<std::size_t>(row));
      }
      clip.frames.push_back(to.data());
    }
  }
};

TEST(Runs, AClipFromMemoryGivesTheRowsOfItsFile) {
  for (const fs::path& path : {clip().path(), clip().deep_path()}) {
    const auto from_file = lines_of(track(request_of(path), session()));
    for (const std::ptrdiff_t gap : {0, 7}) {
      const InMemory memory(path, gap);
      TrackRequest request = request_of("");
      request.clip.source = clip_from_memory(memory.clip);
      EXPECT_EQ(lines_of(track(request, session())), from_file) << path << ", gap " << gap;
    }
  }
}

// A sink's fields are those of the file.
TEST(Runs, SinksSeeEveryRowAndItsField) {
  std::size_t rows = 0, measured = 0;
  const TrackResult result =
      track(request_of(clip().path()), session(), {}, [&](const TrackedFrame& frame) {
        EXPECT_EQ(frame.picture.width(), 160);
        ++rows;
        for (const WindowResult& window : frame.field.windows()) {
          if (window.status != WindowStatus::kOk) {
            EXPECT_TRUE(std::isnan(window.u_px));
            continue;
          }
          ++measured;
          // About the ball's motion: 1, 0.5 px and 2 degrees at 40 px at most.
          EXPECT_LT(std::hypot(window.u_px - 1, window.v_px - 0.5), 1.6);
          EXPECT_LT(std::hypot(window.x_px - frame.row.cx_px, window.y_px - frame.row.cy_px), 40);
        }
      });
  EXPECT_EQ(rows, result.rows.size());
  EXPECT_GT(measured, 9u * 10);
}

// The windows that count are those that the clip's own noise lets be measured.
TEST(Runs, TheNoiseIsTheClipsOwn) {
  TrackRequest request = request_of(clip().path());
  request.estimator = Estimator::kField;
  // Between the best windows and the worst.
  const Inspection look = inspect({request.clip, request.field});
  ASSERT_TRUE(look.advice.texture);
  request.field.max_sd_px = 1.1 * look.advice.texture->asked.error_px;
  const TrackResult result = track(request, session());
  ASSERT_TRUE(result.advice.texture);
  ASSERT_GT(result.advice.texture->noise, 1);
  const auto windows_with = [&](double noise) {
    const auto source = open_clip(request.clip.paths);
    pipeline::TrackOptions options;
    options.estimator.field = request.field;
    options.estimator.field.noise = noise;
    options.frames = {0, 10, 1};
    options.roi = {0, 0, 160, 160};
    options.fps = 10000;
    int windows = 0;
    pipeline::track_clip(
        *source, session().impl().open_engines(), options, [](auto&&...) {},
        [&](const pipeline::TrackedFrame& frame) { windows += frame.row.windows; },
        [](auto&&...) {});
    return windows;
  };
  int windows = 0;
  for (const TrackRow& row : result.rows) windows += row.windows;
  EXPECT_EQ(windows, windows_with(result.advice.texture->noise));
  EXPECT_NE(windows, windows_with(0));
}

// A command gives its devices back before it has ended; whoever goes on gets them again.
TEST(Runs, DevicesGivenBackBesideARunAreStillNamedAndOpenAgain) {
  Session own;
  own.impl().for_one_run = true;
  TrackFolder into;
  for (const char* name : {"given_back", "open_again"}) {
    into.folder = clip().out(name).string();
    track_to_folder(request_of(clip().path()), into, own);
    EXPECT_TRUE(own.impl().engines.empty());
    ASSERT_EQ(own.devices().size(), 1u);
    nlohmann::json summary;
    std::ifstream(clip().out(name) / "summary.json") >> summary;
    EXPECT_EQ(summary["device"]["name"], own.devices().front().name);
  }
}

// The clip's ten frames over and over: `count` frames.
std::shared_ptr<FrameSource> long_clip(const InMemory& memory, std::size_t count) {
  MemoryClip all = memory.clip;
  while (all.frames.size() < count) {
    const std::size_t k = all.frames.size() % 18;  // there and back
    all.frames.push_back(memory.clip.frames[k < 10 ? k : 18 - k]);
  }
  return clip_from_memory(all);
}

TEST(Runs, ACancelledRunKeepsWhatItHasMeasured) {
  constexpr std::size_t kFrames = 1500;
  const InMemory memory(clip().path(), 0);
  TrackRequest request = request_of("");
  request.clip.source = long_clip(memory, kFrames);
  request.with_field = false;
  std::atomic<bool> stop = false;
  RunControl control;
  control.cancelled = [&] { return stop.load(); };
  const TrackResult result = track(request, session(), control, [&](const TrackedFrame& frame) {
    if (frame.row.frame == 20) stop = true;
  });
  EXPECT_TRUE(result.cancelled);
  ASSERT_GT(result.rows.size(), 20u);
  EXPECT_LT(result.rows.size(), kFrames / 2);  // the batch it was at, and those on their way
  for (std::size_t k = 0; k < result.rows.size(); ++k) {
    EXPECT_EQ(result.rows[k].frame, static_cast<std::int64_t>(k));
    EXPECT_TRUE(result.rows[k].circle_ok) << k;
  }
  EXPECT_GT(result.scale.metre_per_px, 0);
}

TEST(Runs, ACancelledFolderHoldsWhatWasMeasuredAndGoesOn) {
  const InMemory memory(clip().path(), 0);
  TrackRequest request = request_of("");
  request.clip.source = long_clip(memory, 600);
  TrackFolder folder;
  folder.folder = clip().out("whole").string();
  const TrackResult whole = track_to_folder(request, folder, session());
  EXPECT_FALSE(whole.cancelled);
  folder.folder = clip().out("cancelled").string();
  RunControl control;
  std::int64_t seen = 0;
  control.progress = [&](const Progress& progress) { seen = progress.done; };
  control.cancelled = [&] { return seen > 0; };
  const TrackResult part = track_to_folder(request, folder, session(), control);
  EXPECT_TRUE(part.cancelled);
  EXPECT_LT(part.rows.size(), whole.rows.size());
  EXPECT_EQ(report::read_track_csv(clip().out("cancelled") / "track.csv").size(), part.rows.size());
  const auto summary = nlohmann::json::parse(read_text(clip().out("cancelled") / "summary.json"));
  EXPECT_EQ(summary["cancelled"], true);
  EXPECT_EQ(summary["frames_analysed"], part.rows.size());
  folder.resume = true;
  EXPECT_FALSE(track_to_folder(request, folder, session()).cancelled);
  for (const char* name : {"track.csv", "pose.csv"}) {
    EXPECT_EQ(read_text(clip().out("cancelled") / name), read_text(clip().out("whole") / name));
  }
  EXPECT_TRUE(same_datasets(clip().out("cancelled"), clip().out("whole")));
}

// A clip whose 7th frame cannot be read.
TEST(Runs, AnErrorOnTheWayLeavesWhatWasMeasured) {
  const auto good = open_clip({clip().path().string()});
  TrackRequest request = request_of("");
  request.clip.source = clip_from_callback(good->info(), [&](std::int64_t index, Frame& frame) {
    if (index == 6) throw FormatError("made.tif", 77, "damaged");
    good->read(index, frame);
  });
  request.frames = {0, 8, 1};
  TrackResult result;
  EXPECT_THROW(track(request, session(), {}, {}, result), FormatError);
  EXPECT_EQ(result.rows.size(), 6u);
  EXPECT_GT(result.scale.metre_per_px, 0);
  EXPECT_FALSE(result.cancelled);
  TrackFolder folder;
  folder.folder = clip().out("damaged").string();
  EXPECT_THROW(track_to_folder(request, folder, session()), FormatError);
  EXPECT_EQ(report::read_track_csv(clip().out("damaged") / "track.csv").size(), 6u);
}

// A file that becomes shorter while it is read is an error of the run: nothing is lent unless
// asked.
TEST(Runs, AFileThatShrinksIsAnErrorOfTheRun) {
  const fs::path raw = clip().out("shrinking.raw");
  {
    const auto source = open_clip({clip().path().string()});
    std::ofstream file(raw, std::ios::binary);
    Frame frame;
    for (int k = 0; k < 60; ++k) {
      source->read(k % 10, frame);
      file.write(static_cast<const char*>(frame.bytes()),
                 static_cast<std::streamsize>(frame.byte_count()));
    }
  }
  TrackRequest request = request_of(raw);
  request.clip.open.raw = RawLayout{160, 160, 8};
  request.with_field = false;
  RunControl control;  // the first word of the run comes when the clip is open
  control.message = [&](const Message&) { fs::resize_file(raw, 10000); };
  EXPECT_THROW(track(request, session(), control), FormatError);
}

TEST(Runs, CorrelateIsTheCommands) {
  ASSERT_EQ(run_program("correlate " + quoted(clip().path()) + " --roi 50,50,60,60 -q -o " +
                        quoted(clip().out("plate")))
                .status,
            0);
  CorrelateRequest request;
  request.clip.paths = {clip().path().string()};
  request.roi = Roi{50, 50, 60, 60};
  CorrelateFolder folder;
  folder.folder = clip().out("plate_library").string();
  const CorrelateResult result = correlate_to_folder(request, folder, session());
  for (const char* name : {"motion.csv", "job.toml"}) {
    EXPECT_EQ(read_text(clip().out("plate") / name), read_text(clip().out("plate_library") / name));
  }
  EXPECT_TRUE(same_datasets(clip().out("plate"), clip().out("plate_library")));
  const CorrelateResult again = correlate(request, session());
  ASSERT_EQ(again.rows.size(), result.rows.size());
  for (std::size_t k = 0; k < again.rows.size(); ++k) {
    EXPECT_EQ(again.rows[k].dx_px, result.rows[k].dx_px);
    EXPECT_EQ(again.rows[k].windows, result.rows[k].windows);
  }
}

}  // namespace
}  // namespace impactdic::testing
