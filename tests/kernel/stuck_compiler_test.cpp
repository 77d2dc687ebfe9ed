// A compiler that runs out of memory throws through the library and leaves its locks closed, as
// PoCL's does. Nobody compiles, runs or releases a program behind that, which would wait for ever.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <atomic>
#include <new>

#include "host/opencl/engine.h"
#include "tests/support/engine.h"
#include "tests/support/scratch.h"

namespace {
std::atomic<bool> is_out_of_memory = false;
std::atomic<int> releases_behind_that = 0;

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}
}  // namespace

// In place of the library's own, for this program alone.
extern "C" cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices,
                                 const char* options, void (*tell)(cl_program, void*), void* data) {
  if (is_out_of_memory) throw std::bad_alloc();
  return next<decltype(clBuildProgram)>("clBuildProgram")(program, count, devices, options, tell,
                                                          data);
}
extern "C" cl_int clReleaseProgram(cl_program program) {
  releases_behind_that += is_out_of_memory ? 1 : 0;
  return next<decltype(clReleaseProgram)>("clReleaseProgram")(program);
}

namespace impactdic {
namespace {

TEST(StuckCompiler, NothingIsCompiledRunOrReleasedBehindIt) {
  const testing::ScratchFolder folder;
  opencl::EngineOptions options;
  options.cache_dir = folder.string();
  const int device = testing::shared_engine().device().index;
  auto engine = std::make_unique<opencl::Engine>(std::to_string(device), options);
  const cl::Kernel before = engine->kernel("frames/unpack.cl", "unpack");
  const auto beside = engine->beside();
  is_out_of_memory = true;
  EXPECT_THROW(engine->kernel("frames/unpack.cl", "unpack", {{"PIXEL", "ushort"}}), std::bad_alloc);
  for (opencl::Engine* one : {engine.get(), beside.get()}) {
    EXPECT_THROW(one->kernel("frames/prefilter.cl", "prefilter_rows"), OpenClError);
    EXPECT_THROW(one->kernel("frames/unpack.cl", "unpack"), OpenClError);
    EXPECT_THROW(one->launch(one->queue(), before, cl::NDRange(64), cl::NDRange(64)), OpenClError);
  }
  EXPECT_EQ(releases_behind_that, 0);
  is_out_of_memory = false;
}

}  // namespace
}  // namespace impactdic
