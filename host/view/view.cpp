#include "host/view/view.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "host/view/answers.h"
#include "host/view/server.h"
#include "host/view/target.h"

namespace impactdic::view {
namespace {

bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

}  // namespace

void serve_page(const ViewRequest& request, const std::function<void(const std::string&)>& ready,
                const std::function<bool()>& stopped) {
  Target target(request.clip);
  RunJob* told = nullptr;
  SessionOptions options = request.session;
  options.on_compile = [&told](const CompileProgress& progress) {
    if (told != nullptr) told->note_compiling(progress);
  };
  Session session(options);
  RunJob run(session);
  told = &run;
  Answers answers(target, session, run);
  Server server(request.port, [&](const PageRequest& asked) { return answers(asked); });
  ready(server.address());
  server.serve(stopped);
}

bool open_browser(const std::string& address) {
  if (is_set("SSH_CONNECTION") || is_set("SSH_TTY")) return false;
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) return false;
  std::string program = "xdg-open", argument = address;
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const bool started =
      ::posix_spawnp(&child, program.c_str(), &quiet, nullptr, arguments, environ) == 0;
  posix_spawn_file_actions_destroy(&quiet);
  // It may end long after, or never.
  if (started) std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
  return started;
}

}  // namespace impactdic::view
