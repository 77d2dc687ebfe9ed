#include "host/video/sandbox/confine.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace impactdic::video::sandbox {
namespace {

// Landlock's own header is as old as the system that this is built on; its numbers stay as they
// are. Each version of the kernel's interface knows more rights.
struct Ruleset {
  std::uint64_t files = 0, ports = 0, scopes = 0;
};
struct __attribute__((packed)) PathRule {
  std::uint64_t allowed = 0;
  std::int32_t file = -1;
};
constexpr std::uint64_t kReadFile = 1U << 2;
constexpr int kPathRule = 1, kAskVersion = 1;
#ifndef SYS_landlock_create_ruleset
#define SYS_landlock_create_ruleset 444
#define SYS_landlock_add_rule 445
#define SYS_landlock_restrict_self 446
#endif

// What can be denied, and how long the kernel expects its description to be.
Ruleset everything(long version, std::size_t& bytes) {
  Ruleset all;
  const int rights = version >= 5 ? 16 : version >= 3 ? 15 : version >= 2 ? 14 : 13;
  all.files = (std::uint64_t{1} << rights) - 1;
  bytes = sizeof(std::uint64_t);
  if (version >= 4) {
    all.ports = 3;  // to listen, to connect
    bytes = 2 * sizeof(std::uint64_t);
  }
  if (version >= 6) {
    all.scopes = 3;  // sockets without a file, signals
    bytes = sizeof(Ruleset);
  }
  return all;
}

// Adds the file to what may be read; false where it is not there.
bool allow_file(int rules, const std::string& path) {
  const int file = ::open(path.c_str(), O_PATH | O_CLOEXEC);
  if (file < 0) return false;
  const PathRule own = {kReadFile, file};
  const bool allowed = ::syscall(SYS_landlock_add_rule, rules, kPathRule, &own, 0) == 0;
  ::close(file);
  return allowed;
}

bool confine_files(const std::vector<std::string>& paths) {
  const long version = ::syscall(SYS_landlock_create_ruleset, nullptr, 0, kAskVersion);
  if (version < 1) return false;
  std::size_t bytes = 0;
  const Ruleset all = everything(version, bytes);
  const auto rules = static_cast<int>(::syscall(SYS_landlock_create_ruleset, &all, bytes, 0));
  if (rules < 0) return false;
  bool any = false;
  for (const std::string& path : paths) any = allow_file(rules, path) || any;
  const bool taken = any && ::syscall(SYS_landlock_restrict_self, rules, 0) == 0;
  ::close(rules);
  return taken;
}

#if defined(__x86_64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kMachine = 0;
#endif

constexpr auto kDenied = std::to_array<long>({
    SYS_socket,
    SYS_connect,
    SYS_bind,
    SYS_listen,
    SYS_accept,
    SYS_accept4,  // the network
    SYS_execve,
    SYS_execveat,  // other programs
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_kill,
    SYS_tkill,  // processes
    SYS_rt_sigqueueinfo,
    SYS_rt_tgsigqueueinfo,
    SYS_pidfd_open,
    SYS_pidfd_send_signal,
    SYS_pidfd_getfd,
    SYS_io_uring_setup,  // what would pass by this filter
    SYS_mount,
    SYS_umount2,
    SYS_unshare,
    SYS_setns,
    SYS_chroot,
    SYS_pivot_root,
    SYS_bpf,
    SYS_userfaultfd,
    SYS_keyctl,
    SYS_add_key,
    SYS_request_key,
    SYS_open_by_handle_at,
#ifdef SYS_fork
    SYS_fork,
    SYS_vfork,
#endif
});

// A program for the kernel that looks at every system call. Arguments are seen by their lower half.
class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    add(BPF_JMP | BPF_JEQ | BPF_K, kMachine, 1, 0);
    add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
    load(offsetof(seccomp_data, nr));
#ifdef __x86_64__
    add(BPF_JMP | BPF_JGE | BPF_K, 0x40000000, 0, 1);  // calls with short pointers
    add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS);
#endif
  }
  void deny(long call, int error = EPERM) {
    add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1);
    add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error));
  }
  // Unless argument `index`, as far as `mask` shows it, is `value`.
  void deny_unless(long call, std::uint32_t index, std::uint32_t mask, std::uint32_t value) {
    add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 5);
    load(static_cast<std::uint32_t>(offsetof(seccomp_data, args)) + 8 * index);
    add(BPF_ALU | BPF_AND | BPF_K, mask);
    add(BPF_JMP | BPF_JEQ | BPF_K, value, 1, 0);
    add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
    load(offsetof(seccomp_data, nr));
  }
  bool install() {
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    const sock_fprog program = {static_cast<unsigned short>(code_.size()), code_.data()};
    return ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) ==
           0;
  }

 private:
  void load(std::size_t at) { add(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(at)); }
  void add(int code, std::uint32_t value, int then = 0, int otherwise = 0) {
    code_.push_back({static_cast<std::uint16_t>(code), static_cast<std::uint8_t>(then),
                     static_cast<std::uint8_t>(otherwise), value});
  }

  std::vector<sock_filter> code_;
};

bool confine_calls() {
  if (kMachine == 0) return false;
  Filter filter;
  for (const long call : kDenied) filter.deny(call);
  // Threads are started, processes are not: clone3's flags lie where a filter cannot see them, and
  // the C library takes clone where it is not there.
  filter.deny(SYS_clone3, ENOSYS);
  filter.deny_unless(SYS_clone, 0, CLONE_THREAD, CLONE_THREAD);
  const auto own = static_cast<std::uint32_t>(::getpid());
  filter.deny_unless(SYS_tgkill, 0, ~0U, own);  // abort() ends by it
  filter.deny_unless(SYS_prlimit64, 0, ~0U, 0);
  return filter.install();
}

}  // namespace

Confined confine(const std::vector<std::string>& paths) {
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);  // without which neither is to be had
  Confined taken;
  taken.files = confine_files(paths);
  taken.network = confine_calls();
  return taken;
}

}  // namespace impactdic::video::sandbox
