#include <impactdic/error.h>

#include <algorithm>
#include <utility>

namespace impactdic {
namespace {

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  return text;
}

// As OpenCL's headers name them; this library does without those.
constexpr std::pair<int, const char*> kOpenClCodes[] = {
    {0, "CL_SUCCESS"},
    {-1, "CL_DEVICE_NOT_FOUND"},
    {-2, "CL_DEVICE_NOT_AVAILABLE"},
    {-3, "CL_COMPILER_NOT_AVAILABLE"},
    {-4, "CL_MEM_OBJECT_ALLOCATION_FAILURE"},
    {-5, "CL_OUT_OF_RESOURCES"},
    {-6, "CL_OUT_OF_HOST_MEMORY"},
    {-11, "CL_BUILD_PROGRAM_FAILURE"},
    {-14, "CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST"},
    {-30, "CL_INVALID_VALUE"},
    {-32, "CL_INVALID_PLATFORM"},
    {-33, "CL_INVALID_DEVICE"},
    {-34, "CL_INVALID_CONTEXT"},
    {-36, "CL_INVALID_COMMAND_QUEUE"},
    {-38, "CL_INVALID_MEM_OBJECT"},
    {-45, "CL_INVALID_PROGRAM_EXECUTABLE"},
    {-46, "CL_INVALID_KERNEL_NAME"},
    {-48, "CL_INVALID_KERNEL"},
    {-49, "CL_INVALID_ARG_INDEX"},
    {-50, "CL_INVALID_ARG_VALUE"},
    {-51, "CL_INVALID_ARG_SIZE"},
    {-52, "CL_INVALID_KERNEL_ARGS"},
    {-54, "CL_INVALID_WORK_GROUP_SIZE"},
    {-55, "CL_INVALID_WORK_ITEM_SIZE"},
    {-58, "CL_INVALID_EVENT"},
    {-59, "CL_INVALID_OPERATION"},
    {-61, "CL_INVALID_BUFFER_SIZE"},
    {-63, "CL_INVALID_GLOBAL_WORK_SIZE"},
    {-1001, "CL_PLATFORM_NOT_FOUND_KHR"},
};

const char* opencl_code_name(int code) {
  for (const auto& [known, name] : kOpenClCodes) {
    if (known == code) return name;
  }
  return "OpenCL error";
}

}  // namespace

Error::Error(const std::string& what, std::string where, std::string hint)
    : std::runtime_error(what), where_(std::move(where)), hint_(std::move(hint)) {}

std::string Error::line() const {
  std::string text = what();
  if (!where_.empty()) text += " (" + where_ + ")";
  if (!hint_.empty()) text += ": " + hint_;
  return one_line(text);
}

FormatError::FormatError(const std::string& file, std::int64_t offset, const std::string& what,
                         const std::string& hint)
    : FileError(what, offset < 0 ? file : file + ", byte " + std::to_string(offset), hint) {}

OpenClError::OpenClError(const std::string& call, int code)
    : Error(std::string("OpenCL call failed: ") + opencl_code_name(code) + " (" +
                std::to_string(code) + ")",
            call) {}

OpenClError::OpenClError(const std::string& what, const std::string& where, const std::string& hint)
    : Error(what, where, hint) {}

}  // namespace impactdic
