// The OpenCL layer itself: devices, sources, cache, buffers, profiler, clFFT plans.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <complex>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <numbers>
#include <numeric>
#include <random>
#include <thread>

#include "host/opencl/arguments.h"
#include "host/opencl/buffer.h"
#include "host/opencl/fft_plan.h"
#include "host/opencl/kernel_source.h"
#include "host/opencl/staging.h"
#include "tests/support/engine.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

using testing::shared_engine;

// A PoCL cache of this process's own: it aborts where a binary is asked for of a kernel that
// another process is just writing into the same cache.
const testing::ScratchFolder& own_pocl_cache() {
  static const testing::ScratchFolder folder;
  return folder;
}
const int kOwnPoclCache = ::setenv("POCL_CACHE_DIR", own_pocl_cache().string().c_str(), 1);

TEST(Device, ChoiceNamesWhatThereIs) {
  const auto devices = opencl::list_devices();
  ASSERT_FALSE(devices.empty());
  EXPECT_EQ(opencl::choose_device(devices, "0").index, 0);
  EXPECT_EQ(opencl::choose_device(devices, devices[0].name.substr(0, 6)).index, 0);
  EXPECT_THROW(opencl::choose_device(devices, "99"), InvalidArgument);
  EXPECT_THROW(opencl::choose_device(devices, "-1"), InvalidArgument);
  EXPECT_THROW(opencl::choose_device(devices, "no such device"), InvalidArgument);
  EXPECT_THROW(opencl::choose_device({}, "auto"), OpenClError);
}

// What one worker gave back is what the next one gets, once nothing uses it.
TEST(Engine, KeepsMemoryForTheNext) {
  opencl::EngineOptions options;
  options.kept_memory_bytes = 1 << 20;
  opencl::Engine engine("auto", options);
  const std::vector<float> values(1000, 7.0F);
  const auto use = [&](std::size_t count) {
    const auto worker = engine.beside();
    opencl::Buffer<float> buffer(*worker, count);
    opencl::Staging staging(*worker);
    staging.upload(1, count, [](std::size_t, std::size_t, unsigned char* to) { *to = 1; });
    buffer.write(*worker, std::span(values).first(count));
    EXPECT_EQ(buffer.to_vector(*worker), std::vector<float>(count, 7.0F));
  };
  // On the queue that the last worker gave back: until it has come to an end with what it used.
  const auto settle = [&] { engine.beside()->wait(); };
  EXPECT_EQ(engine.memory().kept_bytes(), 0u);
  use(1000);
  settle();
  const std::size_t kept = engine.memory().kept_bytes();
  EXPECT_GE(kept, 1000 * sizeof(float) + 2 * 1000);
  use(990);
  settle();
  EXPECT_EQ(engine.memory().kept_bytes(), kept);
  for (int k = 0; k < 9; ++k) opencl::Buffer<float>(engine, 50000 + 8192 * k).write(engine, values);
  EXPECT_LE(engine.memory().kept_bytes(), std::size_t{1} << 20);
  EXPECT_GT(engine.memory().kept_bytes(), std::size_t{1} << 18);
}

TEST(Engine, StopsWhenItIsToldTo) {
  const std::unique_ptr<opencl::Engine> engine = shared_engine().beside();
  const cl::Kernel kernel = engine->kernel("frames/unpack.cl", "unpack", {{"PIXEL", "uchar"}});
  bool stop = false;
  engine->stop_when([&stop] { return stop; });
  const auto launch = [&](opencl::Engine& one) {
    one.launch(one.queue(), kernel, cl::NDRange(64), cl::NDRange(64));
  };
  EXPECT_THROW(launch(*engine), OpenClError);  // gets as far as the device: there are no arguments
  stop = true;
  EXPECT_THROW(launch(*engine), opencl::Stopped);
  EXPECT_THROW(launch(shared_engine()), OpenClError);  // those beside it go on
}

TEST(Engine, AProcessorGetsAnEvenPartOfTheWork) {
  const opencl::Engine& engine = shared_engine();
  const std::size_t part = engine.at_once(1000000, 225);
  if (engine.device().is_gpu) {
    EXPECT_EQ(part, 1000000U);
    return;
  }
  EXPECT_EQ(part % 2, 0U);
  EXPECT_GT(part, 1000U);
  EXPECT_LT(part, 10000U);
  EXPECT_EQ(engine.at_once(3, 225), 3U);
  EXPECT_EQ(engine.at_once(10, 1e9), 2U);
}

TEST(KernelSource, IncludesEachFileOnceWithLineNumbers) {
  const std::string source = opencl::kernel_source("frames/unpack.cl");
  EXPECT_NE(source.find("#line 1 \"kernels/config.h\""), std::string::npos);
  EXPECT_EQ(source.find("#include \"kernels/"), std::string::npos);
  EXPECT_EQ(opencl::kernel_source("frames/unpack.cl", IMPACTDIC_SOURCE_DIR), source);
  EXPECT_THROW(opencl::kernel_source("no_such.cl"), BuildError);
}

TEST(Engine, BuildErrorCarriesLogAndOptions) {
  try {
    shared_engine().kernel("frames/unpack.cl", "unpack", {{"PIXEL", "no_such_type"}});
    FAIL() << "compiled nonsense";
  } catch (const BuildError& error) {
    EXPECT_NE(error.line().find("-DPIXEL=no_such_type"), std::string::npos);
    EXPECT_EQ(error.line().find('\n'), std::string::npos);
  }
}

class Unpack : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Unpack, GivesEveryPixelAndTouchesNothingElse) {
  opencl::Engine& engine = shared_engine();
  const std::size_t count = GetParam();
  constexpr float kCanary = -77.0f;
  std::vector<unsigned short> pixels(count);
  std::iota(pixels.begin(), pixels.end(), static_cast<unsigned short>(60000));
  auto input = opencl::make_buffer<unsigned short>(engine, pixels);
  auto output = opencl::make_buffer<float>(engine, std::vector<float>(count + 64, kCanary));
  auto kept =
      opencl::make_buffer<unsigned short>(engine, std::vector<unsigned short>(count + 64, 77));
  auto kernel = engine.kernel("frames/unpack.cl", "unpack", {{"PIXEL", "ushort"}});
  kernel.setArg(0, input.get());
  kernel.setArg(1, output.get());
  kernel.setArg(2, kept.get());
  kernel.setArg(3, static_cast<cl_ulong>(count));
  kernel.setArg(4, cl_ulong{0});
  engine.launch(engine.queue(), kernel, cl::NDRange(opencl::round_up(count, 64)), cl::NDRange(64));
  const auto result = output.to_vector(engine);
  const auto copies = kept.to_vector(engine);
  for (std::size_t i = 0; i < result.size(); ++i) {
    ASSERT_EQ(result[i], i < count ? static_cast<float>(pixels[i]) : kCanary) << i;
    ASSERT_EQ(copies[i], i < count ? pixels[i] : 77) << i;
  }
}
INSTANTIATE_TEST_SUITE_P(Sizes, Unpack, ::testing::Values(1, 63, 64, 65, 100003));

TEST(Buffer, RefusesToCopyBeyondItsEnd) {
  opencl::Engine& engine = shared_engine();
  opencl::Buffer<float> buffer(engine, 4);
  std::vector<float> host(5);
  EXPECT_THROW(buffer.write(engine, host), InvalidArgument);
  EXPECT_THROW(buffer.read(engine, host), InvalidArgument);
}

// A copy from memory of the host that an exception is about to free.
TEST(Settled, WaitsForWhatTheDeviceStillReads) {
  opencl::Engine& engine = shared_engine();
  const cl::CommandQueue& queue = engine.queue();
  cl::UserEvent gate(engine.context());
  std::thread opener;
  cl::Event copied;
  try {
    const std::vector<float> host(1000, 3.0F);
    opencl::Buffer<float> buffer(engine, host.size());
    const opencl::Settled settled(engine);
    const std::vector<cl::Event> opened = {gate};
    queue.enqueueBarrierWithWaitList(&opened);
    copied = buffer.write_later(engine, host);
    EXPECT_NE(copied.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>(), CL_COMPLETE);
    opener = std::thread([&gate] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      gate.setStatus(CL_COMPLETE);
    });
    throw InvalidArgument("something else");
  } catch (const InvalidArgument&) {
    EXPECT_EQ(copied.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>(), CL_COMPLETE);
  }
  opener.join();
}

// The entry of another key whose name begins alike is not this key's.
TEST(ProgramCache, AKeyEndsWhereItEnds) {
  const testing::ScratchFolder folder;
  const opencl::ProgramCache cache(folder.string());
  cache.store("key", {1, 2, 3});
  const std::filesystem::path short_entry = *std::filesystem::directory_iterator(folder.string());
  EXPECT_EQ(cache.load("key"), (std::vector<unsigned char>{1, 2, 3}));
  cache.store("key and more", {4, 5, 6});
  for (const auto& entry : std::filesystem::directory_iterator(folder.string())) {
    if (entry.path() == short_entry) continue;
    std::filesystem::copy_file(entry.path(), short_entry,
                               std::filesystem::copy_options::overwrite_existing);
  }
  EXPECT_EQ(cache.load("key"), std::nullopt);
}

TEST(ProgramCache, ServesWholeEntriesAndDeletesDamagedOnes) {
  const testing::ScratchFolder folder;
  const opencl::ProgramCache cache(folder.string());
  const std::vector<unsigned char> binary = {1, 0, 2, 255};
  EXPECT_FALSE(cache.load("key"));
  cache.store("key", binary);
  EXPECT_EQ(cache.load("key"), binary);
  EXPECT_FALSE(cache.load("another key"));
  const auto entry = std::filesystem::directory_iterator(folder.string())->path();
  std::fstream(entry, std::ios::in | std::ios::out | std::ios::ate).seekp(-1, std::ios::end) << 'x';
  EXPECT_FALSE(cache.load("key"));
  EXPECT_FALSE(std::filesystem::exists(entry));
}

// Runs `unpack` on a few pixels.
void run_unpack(opencl::Engine& engine, cl::Kernel kernel) {
  auto pixels = opencl::make_buffer<unsigned char>(engine, std::vector<unsigned char>(64, 7));
  const opencl::Buffer<float> image(engine, 64);
  const opencl::Buffer<unsigned char> kept(engine, 64);
  opencl::set_arguments(kernel, pixels.get(), image.get(), kept.get(), cl_ulong{64}, cl_ulong{0});
  engine.launch(engine.queue(), kernel, cl::NDRange(64), cl::NDRange(64));
  engine.queue().finish();
}

// What an engine told about its compiler; OpenCL calls from threads of its own.
class Compiling {
 public:
  CompileFn teller() {
    return [this](const CompileProgress& progress) {
      const std::lock_guard<std::mutex> lock(mutex_);
      told_.push_back(std::to_string(progress.done) + " of " + std::to_string(progress.known) +
                      " " + progress.kernel);
    };
  }
  // All that was told, of which `count` or more is to come within seconds.
  std::vector<std::string> wait_for(std::size_t count) {
    for (int i = 0; i < 500; ++i) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (told_.size() >= count) return told_;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    return told_;
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> told_;
};

class EngineCache : public ::testing::Test {
 protected:
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_.string()),
                      std::filesystem::directory_iterator()));
  }
  std::unique_ptr<opencl::Engine> engine(bool keep_programs, Compiling* compiling) {
    opencl::EngineOptions options;
    options.cache_dir = folder_.string();
    options.keep_programs = keep_programs;
    options.on_compile = compiling->teller();
    return std::make_unique<opencl::Engine>(std::to_string(shared_engine().device().index),
                                            options);
  }
  testing::ScratchFolder folder_;
};

TEST_F(EngineCache, CompiledProgramsComeBackInANewEngine) {
  Compiling first, second;
  const auto compiles = engine(true, &first);
  run_unpack(*compiles, compiles->kernel("frames/unpack.cl", "unpack"));
  EXPECT_EQ(first.wait_for(2),
            (std::vector<std::string>{"0 of 1 frames/unpack.cl", "1 of 1 frames/unpack.cl"}));
  EXPECT_EQ(entries(), 1U);
  const auto reads = engine(true, &second);
  run_unpack(*reads, reads->kernel("frames/unpack.cl", "unpack"));
  EXPECT_TRUE(second.wait_for(0).empty());
  EXPECT_EQ(entries(), 1U);
}

// A driver that keeps programs itself compiles a kernel when it first runs. No binary is asked for,
// which would compile it once more; the entry is a note.
TEST_F(EngineCache, OfADriverThatKeepsProgramsThereIsANote) {
  Compiling first, second;
  const auto compiles = engine(false, &first);
  const auto other = compiles->beside();
  const cl::Kernel kernel = compiles->kernel("frames/unpack.cl", "unpack");
  const cl::Kernel of_other = other->kernel("frames/unpack.cl", "unpack");
  EXPECT_EQ(first.wait_for(1), std::vector<std::string>{"0 of 1 frames/unpack.cl:unpack"});
  run_unpack(*other, of_other);
  run_unpack(*compiles, kernel);
  EXPECT_EQ(first.wait_for(2), (std::vector<std::string>{"0 of 1 frames/unpack.cl:unpack",
                                                         "1 of 1 frames/unpack.cl:unpack"}));
  ASSERT_EQ(entries(), 1U);
  EXPECT_LT(std::filesystem::file_size(*std::filesystem::directory_iterator(folder_.string())),
            20'000U);
  const auto knows = engine(false, &second);
  run_unpack(*knows, knows->kernel("frames/unpack.cl", "unpack"));
  EXPECT_TRUE(second.wait_for(0).empty());
  // The note is no program: an engine that keeps programs compiles, and replaces it.
  Compiling third;
  const auto keeps = engine(true, &third);
  run_unpack(*keeps, keeps->kernel("frames/unpack.cl", "unpack"));
  EXPECT_EQ(third.wait_for(2).size(), 2U);
  EXPECT_EQ(entries(), 1U);
}

TEST(Profiler, CountsCallsBytesAndFlops) {
  opencl::EngineOptions options;
  options.profile = true;
  opencl::Engine engine(std::to_string(shared_engine().device().index), options);
  auto pixels = opencl::make_buffer<unsigned char>(engine, std::vector<unsigned char>(1000, 7));
  opencl::Buffer<float> image(engine, 1000);
  opencl::Buffer<unsigned char> kept(engine, 1000);
  auto kernel = engine.kernel("frames/unpack.cl", "unpack");
  kernel.setArg(0, pixels.get());
  kernel.setArg(1, image.get());
  kernel.setArg(2, kept.get());
  kernel.setArg(3, cl_ulong{1000});
  kernel.setArg(4, cl_ulong{0});
  for (int i = 0; i < 3; ++i) {
    engine.launch(engine.queue(), kernel, cl::NDRange(1024), cl::NDRange(64), {5000, 1000});
  }
  bool seen = false;
  for (const opencl::ProfileRow& row : engine.profiler().rows()) {
    if (row.name != "unpack") continue;
    seen = true;
    EXPECT_EQ(row.calls, 3u);
    EXPECT_EQ(row.bytes, 15000);
    EXPECT_EQ(row.flops, 3000);
    EXPECT_GE(row.total_s, row.median_s);
  }
  EXPECT_TRUE(seen);
  EXPECT_NE(engine.profiler().table().find("copy to device"), std::string::npos);
}

TEST(FftPlan, MatchesTheDefinitionAndInverts) {
  opencl::Engine& engine = shared_engine();
  constexpr std::size_t kWidth = 12, kHeight = 10, kBatch = 3;
  using Complex = std::complex<float>;
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<Complex> data(kWidth * kHeight * kBatch);
  for (Complex& value : data) value = {normal(random), normal(random)};
  auto buffer = opencl::make_buffer<Complex>(engine, data);
  opencl::FftPlan plan(engine, kWidth, kHeight, kBatch);
  plan.forward(engine.queue(), buffer.get());
  const auto spectrum = buffer.to_vector(engine);
  // One coefficient of the last picture by the definition of the transform.
  const std::size_t kx = 5, ky = 3, base = 2 * kWidth * kHeight;
  std::complex<double> sum = 0;
  for (std::size_t y = 0; y < kHeight; ++y) {
    for (std::size_t x = 0; x < kWidth; ++x) {
      const double turns =
          static_cast<double>(kx * x) / kWidth + static_cast<double>(ky * y) / kHeight;
      sum += std::complex<double>(data[base + y * kWidth + x]) *
             std::polar(1.0, -2 * std::numbers::pi * turns);
    }
  }
  const auto got = std::complex<double>(spectrum[base + ky * kWidth + kx]);
  // Single precision over 120 terms of size one.
  EXPECT_NEAR(std::abs(got - sum), 0, 1e-4);
  plan.inverse(engine.queue(), buffer.get());
  const auto back = buffer.to_vector(engine);
  for (std::size_t i = 0; i < data.size(); ++i) ASSERT_NEAR(std::abs(back[i] - data[i]), 0, 1e-5);
}

// Workers of one device that come to the same new plan at once.
TEST(FftPlan, ThreadsMakeTheSamePlan) {
  std::vector<std::unique_ptr<opencl::Engine>> engines;
  for (int k = 0; k < 4; ++k) engines.push_back(shared_engine().beside());
  std::vector<std::thread> workers;
  std::atomic<int> made = 0;
  for (const auto& engine : engines) {
    workers.emplace_back([&made, &engine] {
      const opencl::FftPlan plan(*engine, 14, 1, 3);
      made += plan.batch() == 3 ? 1 : 0;
    });
  }
  for (std::thread& worker : workers) worker.join();
  EXPECT_EQ(made, 4);
}

TEST(FftPlan, GoodSizesAreProductsOfSmallPrimes) {
  EXPECT_EQ(opencl::FftPlan::good_size(31), 32u);
  EXPECT_EQ(opencl::FftPlan::good_size(17), 18u);
  EXPECT_EQ(opencl::FftPlan::good_size(49), 49u);
  EXPECT_EQ(opencl::FftPlan::good_size(1), 1u);
}

}  // namespace
}  // namespace impactdic
