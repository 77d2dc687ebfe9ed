#include "host/opencl/fft_plan.h"

#include <clFFT.h>
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <mutex>

namespace impactdic::opencl {
namespace {

void check(clfftStatus status, const char* call) {
  if (status != CLFFT_SUCCESS) throw OpenClError(call, static_cast<int>(status));
}

// clFFT ends the process where two threads bring it a program of the same plan, and is not to be
// torn down while another plan is made.
std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

// clFFT's own global state: set up with the first plan, torn down with the last one. Shared and let
// go of by one thread at a time.
class Library {
 public:
  Library() {
    clfftSetupData data;
    check(clfftInitSetupData(&data), "clfftInitSetupData");
    check(clfftSetup(&data), "clfftSetup");
  }
  ~Library() { clfftTeardown(); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  static std::shared_ptr<Library> share() {
    static std::weak_ptr<Library> current;
    std::shared_ptr<Library> library = current.lock();
    if (!library) current = library = std::make_shared<Library>();
    return library;
  }
};

}  // namespace

struct FftPlan::Impl {
  std::shared_ptr<Library> library;
  Engine& engine;
  std::size_t width, height, batch;
  clfftPlanHandle handle = 0;

  Impl(Engine& owner, std::size_t w, std::size_t h, std::size_t b)
      : engine(owner), width(w), height(h), batch(b) {
    const std::lock_guard<std::mutex> lock(one_at_a_time());
    library = Library::share();
  }
  ~Impl() {
    const std::lock_guard<std::mutex> lock(one_at_a_time());
    clfftDestroyPlan(&handle);
    library.reset();
  }

  void run(const cl::CommandQueue& queue, const cl::Buffer& data, clfftDirection direction) {
    cl_command_queue raw_queue = queue();
    cl_mem raw_data = data();
    cl_event raw_event = nullptr;
    check(clfftEnqueueTransform(handle, direction, 1, &raw_queue, 0, nullptr, &raw_event, &raw_data,
                                nullptr, nullptr),
          "clfftEnqueueTransform");
    const double points = static_cast<double>(width * height * batch);
    engine.profiler().add("clfft", cl::Event(raw_event), 16 * points,
                          5 * points * std::log2(static_cast<double>(width * height)));
  }
};

FftPlan::FftPlan(Engine& engine, std::size_t width, std::size_t height, std::size_t batch)
    : impl_(std::make_unique<Impl>(engine, width, height, batch)) {
  const std::lock_guard<std::mutex> lock(one_at_a_time());
  const std::size_t lengths[2] = {width, height};
  clfftPlanHandle& plan = impl_->handle;
  check(
      clfftCreateDefaultPlan(&plan, engine.context()(), height == 1 ? CLFFT_1D : CLFFT_2D, lengths),
      "clfftCreateDefaultPlan");
  check(clfftSetPlanPrecision(plan, CLFFT_SINGLE), "clfftSetPlanPrecision");
  check(clfftSetLayout(plan, CLFFT_COMPLEX_INTERLEAVED, CLFFT_COMPLEX_INTERLEAVED),
        "clfftSetLayout");
  check(clfftSetResultLocation(plan, CLFFT_INPLACE), "clfftSetResultLocation");
  check(clfftSetPlanBatchSize(plan, batch), "clfftSetPlanBatchSize");
  cl_command_queue queue = engine.queue()();
  check(clfftBakePlan(plan, 1, &queue, nullptr, nullptr), "clfftBakePlan");
}

FftPlan::~FftPlan() = default;
FftPlan::FftPlan(FftPlan&&) noexcept = default;
FftPlan& FftPlan::operator=(FftPlan&&) noexcept = default;

void FftPlan::forward(const cl::CommandQueue& queue, const cl::Buffer& data) {
  impl_->run(queue, data, CLFFT_FORWARD);
}
void FftPlan::inverse(const cl::CommandQueue& queue, const cl::Buffer& data) {
  impl_->run(queue, data, CLFFT_BACKWARD);
}
std::size_t FftPlan::batch() const { return impl_->batch; }

std::size_t FftPlan::good_size(std::size_t length) {
  for (std::size_t size = std::max<std::size_t>(length, 1);; ++size) {
    std::size_t rest = size;
    for (std::size_t prime : {2, 3, 5, 7, 11, 13}) {
      while (rest % prime == 0) rest /= prime;
    }
    if (rest == 1) return size;
  }
}

}  // namespace impactdic::opencl
