// `track` for every clip of a folder, and one table.
#pragma once

#include <impactdic/export.h>
#include <impactdic/track.h>

#include <optional>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// How several processes, on any machines that see the folder of results, share the shots of one
// batch. Each calls `batch` with the same request but for `shard` and `member`. They need neither
// locks nor a launcher: each shot has a file as its ticket, which is renamed by whoever takes it.
// A process that ends without having said so is named, and its shots go to the others.
struct BatchShare {
  std::string name;    // of this run, the same in all its processes: letters, digits, '-' and '_';
                       // a run that was interrupted is gone on with under its name. "": not shared
  std::string member;  // what messages call this process; "": by its machine and number
  int shard = 0;       // 1 … shards: takes only the shots K, K + N, … of the list
  int shards = 0;      // 0: takes whatever is left
  // A process that has not been heard of for so long is given up, one of this machine as soon as it
  // ends. 1 … 86400 s. One whose work stands still for ten times as long counts as silent.
  double lost_after_s = 60;
  bool join = false;  // measures nothing: writes the table of what there is
};

struct BatchRequest {
  std::string folder;  // of clips, or of folders of pictures
  // CSV: file, and any of surface_angle_deg, ball_diameter_mm, inertia_factor, drop_height_mm,
  // camera (a file beside the table), ball, mass_g, notes; an empty cell is as if the column were
  // missing. "": none.
  std::string table;
  TrackRequest track;  // of every shot; its clip's paths and source are those of the shot
  TrackFolder output;  // the batch's own folder, and how shots are written; `resume` keeps what
                       // an earlier run measured, and works out anew what the table, the scale
                       // or the angles now say otherwise
  int clips = 0;       // measured at a time, 0 … 64; 0: as many as threads, up to 4
  BatchShare share;
  void validate() const;  // throws InvalidArgument
};

// One shot of a batch.
struct ShotResult {
  std::string file, name;  // of the clip, and of the folder of its results
  bool listed = false;     // stands in the table
  bool done = false;
  bool measured_now = false;  // false: taken over from an earlier run
  bool missing = false;       // of a share: no process has measured it, or tried to
  std::string reason;         // why it failed, one line
  std::string drop_height_mm, notes, ball, mass_g;                        // as the table has them
  double ball_diameter_mm = kNotMeasured, inertia_factor = kNotMeasured;  // as the shot was given
  double surface_angle_deg = kNotMeasured;
  std::int64_t frames = 0, frames_ok = 0;
  double metre_per_px = kNotMeasured, metre_per_px_sd = kNotMeasured;
  ImpactFigures impact;
};

struct BatchResult {
  std::vector<ShotResult> shots;  // in natural order of their files
  std::size_t failed = 0;         // of them
  std::size_t missing = 0;        // of them
  bool joined = true;  // false: `shots` are those of this process; another writes the table
  std::string table;   // path of shots.csv
  std::vector<std::string> warnings;
  bool cancelled = false;  // shots without `done` and `reason` were not tried
};

// Writes shots/NAME/ with what track_to_folder writes of each clip, quarantine/NAME/reason.txt of
// those that failed, and shots.csv with a row for each. A shot is measured in a folder ending in
// .part that gets its name when it is complete: a run that was killed leaves no half result.
// Throws InvalidArgument before anything is measured; OpenClError where the device fails; FileError
// where the disk does; Error where none of the shots could be measured, or where shots of a share
// are missing, after the table that says so is written.
BatchResult batch(const BatchRequest& request, Session& session, const RunControl& control = {});

}  // namespace impactdic
