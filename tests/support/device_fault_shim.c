/* The kind `device` of the shim: calls of OpenCL that fail as they do where a device is lost or has
 * no memory left. Taking and releasing references is left alone. What waits does so before it
 * fails: work that a driver calls failed is not running any more. */
#define _GNU_SOURCE
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_1_APIS
#include <CL/cl.h>
#include <dlfcn.h>
#include <stddef.h>

#include "tests/support/fault_shim.h"

static int fails(void) { return fault_concerns("device") && fault_fails(); }

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

/* A call that gives a status. */
#define STATUS(name, declared, given) \
  cl_int name declared { return fails() ? CL_OUT_OF_RESOURCES : NEXT(name) given; }
/* One that gives an object, and its status through its last argument. */
#define OBJECT(type, name, declared, given)              \
  type name declared {                                   \
    if (fails()) {                                       \
      if (status != NULL) *status = CL_OUT_OF_RESOURCES; \
      return NULL;                                       \
    }                                                    \
    return NEXT(name) given;                             \
  }

STATUS(clGetPlatformIDs, (cl_uint n, cl_platform_id* p, cl_uint* count), (n, p, count))
STATUS(clGetPlatformInfo,
       (cl_platform_id p, cl_platform_info what, size_t n, void* v, size_t* size),
       (p, what, n, v, size))
STATUS(clGetDeviceIDs, (cl_platform_id p, cl_device_type t, cl_uint n, cl_device_id* d, cl_uint* c),
       (p, t, n, d, c))
STATUS(clGetDeviceInfo, (cl_device_id d, cl_device_info what, size_t n, void* v, size_t* size),
       (d, what, n, v, size))
STATUS(clGetEventInfo, (cl_event e, cl_event_info what, size_t n, void* v, size_t* size),
       (e, what, n, v, size))
STATUS(clGetKernelInfo, (cl_kernel k, cl_kernel_info what, size_t n, void* v, size_t* size),
       (k, what, n, v, size))
STATUS(clGetProgramInfo, (cl_program p, cl_program_info what, size_t n, void* v, size_t* size),
       (p, what, n, v, size))
STATUS(clGetProgramBuildInfo,
       (cl_program p, cl_device_id d, cl_program_build_info what, size_t n, void* v, size_t* size),
       (p, d, what, n, v, size))
STATUS(clGetContextInfo, (cl_context c, cl_context_info what, size_t n, void* v, size_t* size),
       (c, what, n, v, size))
STATUS(clGetCommandQueueInfo,
       (cl_command_queue q, cl_command_queue_info what, size_t n, void* v, size_t* size),
       (q, what, n, v, size))
STATUS(clBuildProgram,
       (cl_program p, cl_uint n, const cl_device_id* d, const char* options,
        void(CL_CALLBACK* tell)(cl_program, void*), void* data),
       (p, n, d, options, tell, data))
STATUS(clSetKernelArg, (cl_kernel k, cl_uint i, size_t n, const void* v), (k, i, n, v))
STATUS(clSetEventCallback,
       (cl_event e, cl_int when, void(CL_CALLBACK* tell)(cl_event, cl_int, void*), void* data),
       (e, when, tell, data))
STATUS(clFlush, (cl_command_queue q), (q))
STATUS(clEnqueueNDRangeKernel,
       (cl_command_queue q, cl_kernel k, cl_uint d, const size_t* o, const size_t* g,
        const size_t* l, cl_uint n, const cl_event* w, cl_event* e),
       (q, k, d, o, g, l, n, w, e))
STATUS(clEnqueueReadBuffer,
       (cl_command_queue q, cl_mem m, cl_bool b, size_t o, size_t s, void* p, cl_uint n,
        const cl_event* w, cl_event* e),
       (q, m, b, o, s, p, n, w, e))
STATUS(clEnqueueWriteBuffer,
       (cl_command_queue q, cl_mem m, cl_bool b, size_t o, size_t s, const void* p, cl_uint n,
        const cl_event* w, cl_event* e),
       (q, m, b, o, s, p, n, w, e))
STATUS(clEnqueueCopyBuffer,
       (cl_command_queue q, cl_mem a, cl_mem b, size_t i, size_t o, size_t s, cl_uint n,
        const cl_event* w, cl_event* e),
       (q, a, b, i, o, s, n, w, e))
STATUS(clEnqueueFillBuffer,
       (cl_command_queue q, cl_mem m, const void* p, size_t ps, size_t o, size_t s, cl_uint n,
        const cl_event* w, cl_event* e),
       (q, m, p, ps, o, s, n, w, e))
STATUS(clEnqueueUnmapMemObject,
       (cl_command_queue q, cl_mem m, void* p, cl_uint n, const cl_event* w, cl_event* e),
       (q, m, p, n, w, e))
STATUS(clEnqueueMarkerWithWaitList, (cl_command_queue q, cl_uint n, const cl_event* w, cl_event* e),
       (q, n, w, e))

cl_int clFinish(cl_command_queue q) {
  const cl_int ended = NEXT(clFinish)(q);
  return fails() ? CL_OUT_OF_RESOURCES : ended;
}
cl_int clWaitForEvents(cl_uint n, const cl_event* events) {
  const cl_int ended = NEXT(clWaitForEvents)(n, events);
  return fails() ? CL_OUT_OF_RESOURCES : ended;
}

OBJECT(cl_context, clCreateContext,
       (const cl_context_properties* p, cl_uint n, const cl_device_id* d,
        void(CL_CALLBACK* tell)(const char*, const void*, size_t, void*), void* data,
        cl_int* status),
       (p, n, d, tell, data, status))
OBJECT(cl_command_queue, clCreateCommandQueue,
       (cl_context c, cl_device_id d, cl_command_queue_properties p, cl_int* status),
       (c, d, p, status))
OBJECT(cl_mem, clCreateBuffer, (cl_context c, cl_mem_flags f, size_t s, void* p, cl_int* status),
       (c, f, s, p, status))
OBJECT(cl_program, clCreateProgramWithSource,
       (cl_context c, cl_uint n, const char** s, const size_t* l, cl_int* status),
       (c, n, s, l, status))
OBJECT(cl_program, clCreateProgramWithBinary,
       (cl_context c, cl_uint n, const cl_device_id* d, const size_t* l, const unsigned char** b,
        cl_int* each, cl_int* status),
       (c, n, d, l, b, each, status))
OBJECT(cl_kernel, clCreateKernel, (cl_program p, const char* name, cl_int* status),
       (p, name, status))
OBJECT(void*, clEnqueueMapBuffer,
       (cl_command_queue q, cl_mem m, cl_bool b, cl_map_flags f, size_t o, size_t s, cl_uint n,
        const cl_event* w, cl_event* e, cl_int* status),
       (q, m, b, f, o, s, n, w, e, status))
