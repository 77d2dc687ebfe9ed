// `impactdic view`: the page on this machine.
#pragma once

#include <impactdic/clip.h>
#include <impactdic/device.h>

#include <functional>
#include <string>

namespace impactdic::view {

struct ViewRequest {
  ClipRequest clip;        // its paths name a clip, or a folder that holds results
  SessionOptions session;  // for what is measured from the page
  int port = 0;            // 0: a free one
};

// Serves the page until `stopped`; `ready` gets its address once it can be opened. Throws
// InvalidArgument, FileError, FormatError where there is nothing to show.
void serve_page(const ViewRequest& request, const std::function<void(const std::string&)>& ready,
                const std::function<bool()>& stopped);

// Opens the address in the user's browser. False where there is none to be seen: over ssh, or
// without a screen.
bool open_browser(const std::string& address);

}  // namespace impactdic::view
