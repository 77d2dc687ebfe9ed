// What `impactdic view` was given: a clip, the results of a run, those of a batch or of a fit.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "host/view/shot.h"

namespace impactdic::view {

class Target {
 public:
  // `clip.paths` names a clip, or one folder that holds results; that of a `fit` shows the tracks
  // which it was made on. Throws InvalidArgument, FileError,
  // FormatError where it is a clip that cannot be read.
  explicit Target(const ClipRequest& clip);

  // For the page's title: the last part of the path.
  const std::string& title() const { return title_; }
  // Names of a batch's shots, in the order of its table, or of a fit's tracks; empty of anything
  // else.
  const std::vector<std::string>& shots() const { return shots_; }
  // Of a batch: shots.csv as it stands; else "".
  std::string shots_table() const;
  // Shots of a batch that are left out of its means, and why: excluded.csv, `shot,reason`. A reason
  // of "" takes a shot in again. Throws NotThere for what is no shot of the table, FileError.
  std::map<std::string, std::string> excluded() const;
  void exclude(const std::string& shot, const std::string& reason);
  // Of a fit: its parameters as JSON, {name: {"value", "sd", ...}}; else "{}".
  const std::string& parameters() const { return parameters_; }
  // "": the clip or the results themselves; else one of `shots`. Throws NotThere.
  std::shared_ptr<Shot> shot(const std::string& name);

 private:
  struct Fitted {
    std::filesystem::path results, residuals;
  };
  void read_fit(const std::filesystem::path& folder);

  std::filesystem::path batch_;
  std::map<std::string, Fitted> fitted_;  // by the name of the shot
  std::string parameters_ = "{}";
  std::string title_;
  std::vector<std::string> shots_;
  mutable std::mutex mutex_;  // of excluded.csv, and of what follows
  std::map<std::string, std::shared_ptr<Shot>> open_;
};

// The clip that the job.toml of `folder` names, with how it is read. Throws as read_job_file.
ClipRequest clip_of_results(const std::filesystem::path& folder);

}  // namespace impactdic::view
