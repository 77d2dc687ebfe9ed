// What the commands that measure a clip into a folder share: track, correlate.
#pragma once

#include <cstdio>

#include "host/app/command.h"
#include "host/app/run_context.h"
#include "host/run/session.h"

namespace impactdic::app {

template <typename Request, typename Folder>
struct ClipCommand {
  Common common;
  Request request;
  Folder folder;
};

// Opens the devices asked for and has `run` (track_to_folder and the like) measure the clip, shows
// how that goes, and has `print` say the result unless the command is quiet. Returns the result.
template <typename Request, typename Folder, typename Run, typename Print>
auto run_clip_command(ClipCommand<Request, Folder>& command, Run run, Print print) {
  Session session = open_session(command.common);
  session.impl().for_one_run = true;
  command.folder.force = command.common.force;
  command.request.clip.open.lend_file_memory = true;  // main() answers for a file that is lost
  Terminal terminal(command.common.quiet);
  auto result = run(command.request, command.folder, session, terminal.control());
  terminal.end();
  if (!command.common.quiet) print(result);
  std::fputs(session.profile().c_str(), stderr);
  return result;
}

}  // namespace impactdic::app
