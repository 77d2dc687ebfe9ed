// The main job: a ball's centre, motion and field in every frame of a clip, and its impact.
//
// Image axes: x right, y down, pixel centres at integers, (0, 0) the centre of the top-left pixel.
// Rotation is positive counter-clockwise as seen on the screen. A motion in row k leads from frame
// k to the next analysed frame.
#pragma once

#include <impactdic/advice.h>
#include <impactdic/circle.h>
#include <impactdic/clip.h>
#include <impactdic/control.h>
#include <impactdic/device.h>
#include <impactdic/export.h>
#include <impactdic/field.h>
#include <impactdic/impact.h>
#include <impactdic/units.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// How the ball's motion is measured.
enum class Estimator {
  kField,  // interrogation windows on the ball, robust rigid fit to their displacements
  kRing,   // the field's translation, the rotation from rings about the centre: any angle, unseeded
  kBall,   // one registration of the whole ball; affine while it is compressed; poses without drift
};
const char* to_string(Estimator estimator);
Estimator parse_estimator(const std::string& name);  // throws InvalidArgument

// What turns: a flat picture in its plane (a disc, a wheel, a ball whose spin stays in the plane),
// or a sphere about any axis. kAuto: as the pictures show. kSpheroid cannot be asked for: what
// turns about any axis and is found to be no sphere, by an outline that is an ellipse and changes.
enum class Body { kAuto, kSphere, kDisc, kSpheroid };
const char* to_string(Body body);
Body parse_body(const std::string& name);  // throws InvalidArgument

enum class TrackStatus {
  kOk,
  kNoBall,          // no circle was found in this frame, or in the next one
  kNoTexture,       // too few windows have contrast enough to be correlated
  kLowCorrelation,  // too few windows were found again in the next frame
  kOutOfView,       // the ball has left the picture
  kLastFrame,       // the circle is measured; there is no next frame to move to
  kInconsistent,    // motion, circle and place on keyframes contradict each other, beyond chance
  kRepeated,        // this frame, or the next one, is the picture before it, or a part of it
};
const char* to_string(TrackStatus status);
// Throws InvalidArgument for a word that is no status.
TrackStatus parse_track_status(const std::string& word);

// Where a ball is and how far it has turned since frame `origin`, by registration against frame
// `keyframe` (frames of the stored file in a TrackRow): the place of the material point that was
// the circle's centre in frame `origin`, and the angle, not wrapped, counter-clockwise on screen.
// Standard deviations are of the pose against that of frame `origin`. A sphere has no such angle,
// but the unit quaternion (qw, qx, qy, qz) that turns it from frame `origin` to here, in the
// camera's axes (X right, Y up, Z towards the camera); angle_sd_rad is then that of a small turn
// about Z, tilt_x_sd_rad and tilt_y_sd_rad those about X and Y. Of a flat ball it stands for the
// angle. key_... is a sphere's registration itself: how far the point that was the keyframe's
// circle's centre has moved, and its rotation vector, with the radius that the run began with; NaN
// of a frame that was placed by the motion from the one before.
struct BodyPose {
  bool ok = false;
  double x_px = kNotMeasured, y_px = kNotMeasured, angle_rad = kNotMeasured;
  double x_sd_px = kNotMeasured, y_sd_px = kNotMeasured, angle_sd_rad = kNotMeasured;
  double qw = kNotMeasured, qx = kNotMeasured, qy = kNotMeasured, qz = kNotMeasured;
  double tilt_x_sd_rad = kNotMeasured, tilt_y_sd_rad = kNotMeasured;
  double key_dx_px = kNotMeasured, key_dy_px = kNotMeasured;
  double key_rot_x_deg = kNotMeasured, key_rot_y_deg = kNotMeasured, key_rot_deg = kNotMeasured;
  std::int64_t origin = -1, keyframe = -1;
};

// One frame. Pixels in image axes (x right, y down); the motion is from this frame to the next
// analysed one. Fields that were not measured are NaN (see `circle_ok` and `motion_ok`). Units are
// those of track.csv: a row that is read back is the same to the last bit.
struct TrackRow {
  std::int64_t frame = 0;  // in the stored file
  double time_s = 0;       // since the first analysed frame; NaN without a frame rate
  TrackStatus status = TrackStatus::kNoBall;
  bool circle_ok = false, motion_ok = false;
  double cx_px = kNotMeasured, cy_px = kNotMeasured, r_px = kNotMeasured;
  double cx_sd_px = kNotMeasured, cy_sd_px = kNotMeasured, r_sd_px = kNotMeasured;
  // Where the rim demands an ellipse, NaN of a circle: at the angle φ (from x towards y, y down)
  // the rim is r_px + e1_px cos 2φ + e2_px sin 2φ from the centre. Its semi-axes are r_px ± |e|,
  // the long one at atan2(e2, e1) / 2.
  double e1_px = kNotMeasured, e2_px = kNotMeasured;
  double e1_sd_px = kNotMeasured, e2_sd_px = kNotMeasured;
  // Of a sphere that its turns place: how far beside its centre its rim's own centre lies, which
  // errs by itself where the centres of neighbours err alike; NaN where the rim's is the centre.
  double rim_off_x_px = kNotMeasured, rim_off_y_px = kNotMeasured;
  double rim_x_sd_px = kNotMeasured, rim_y_sd_px = kNotMeasured;
  ByHand by_hand = ByHand::kNo;
  double dx_px = kNotMeasured, dy_px = kNotMeasured, rot_deg = kNotMeasured;
  double dx_sd_px = kNotMeasured, dy_sd_px = kNotMeasured, rot_sd_deg = kNotMeasured;
  // The displacement field interpolated at the centroid, the dissertation's velocity of the centre.
  double centre_u_px = kNotMeasured, centre_v_px = kNotMeasured;
  double centre_u_sd_px = kNotMeasured, centre_v_sd_px = kNotMeasured;
  // Of a sphere, NaN of a flat ball: rot_deg is the component towards the camera of the rotation
  // vector, these are those to the right and up. Displacement and turn about the axis across it
  // look alike; the correlation of their errors.
  double rot_x_deg = kNotMeasured, rot_y_deg = kNotMeasured;
  double rot_x_sd_deg = kNotMeasured, rot_y_sd_deg = kNotMeasured;
  double dx_rot_y_corr = kNotMeasured, dy_rot_x_corr = kNotMeasured;
  int windows = 0;  // interrogation windows that carried the motion
  int periods = 1;  // of the analysed frames to the next one: more where the camera lost frames
  BodyPose pose;    // where keyframes are kept
};

// From pixels and frames to metres and seconds. World axes: x right, y up, origin at the centre
// of the bottom-left pixel. Local axes: t along the surface, n out of it.
struct SiScale {
  double metre_per_px = 0;
  double fps = 0;                // analysed frames a second
  double surface_angle_rad = 0;  // of the surface, counter-clockwise from image-right
  int image_height = 0;
  double metre_per_px_sd = 0, fps_sd = 0;  // standard deviations
};

// Deviations hold those of scale and rate, which all rows have in common.
struct SiRow {
  double x_m, y_m, vx_m_s, vy_m_s, vt_m_s, vn_m_s, omega_rad_s;
  double vx_sd_m_s, vy_sd_m_s, omega_sd_rad_s;
  // Of a sphere: spin about the surface's t and n; omega_rad_s is that about t x n, to the camera.
  double omega_t_rad_s, omega_n_rad_s, omega_t_sd_rad_s, omega_n_sd_rad_s;
  // Towards the camera: of the free flight that the row belongs to, out of how its radius grows.
  // NaN in contact, and where the camera's distance is not known.
  double vz_m_s = kNotMeasured, vz_sd_m_s = kNotMeasured;
};

// The camera's own part of a row's deviations, which all rows have in common.
struct CameraRowSd {
  double vx_m_s = 0, vy_m_s = 0, omega_rad_s = 0;
};

// What a calibrated camera makes of a track.
struct CameraFigures {
  std::string from;                // what it was calibrated with (Camera::from)
  Measured metre_per_px;           // in the plane of motion, at the picture's middle
  double tilt_deg = kNotMeasured;  // against that plane
  Measured before_plane_m;         // how much nearer the ball flies, where its diameter tells
  // The track as a camera would have it that looks squarely at the plane of motion and bends
  // nothing, SiScale::metre_per_px a pixel; and the camera's part in what follows from it.
  std::vector<TrackRow> rows;
  std::vector<CameraRowSd> row_sd;
};

// Every figure NaN that has no source; lengths all NaN where `scale.metre_per_px` is 0, rates all
// NaN where `scale.fps` is 0.
SiRow to_si(const TrackRow& row, const SiScale& scale);

// Bounds of a radius, px.
struct RadiusRange {
  double low_px = 0, high_px = 0;
};

// Everything that decides a number of the result.
// What is made of a background that moves in the pictures: of a camera that shakes.
enum class CameraMotionUse { kCorrect, kIgnore };
const char* to_string(CameraMotionUse use);
CameraMotionUse parse_camera_motion(const std::string& name);  // throws InvalidArgument

struct TrackRequest {
  ClipRequest clip;
  FrameRange frames = {0, kToTheEnd, 1};  // of the stored file; the part that it has
  std::optional<Roi> roi;                 // the rectangle that is looked at; all of the picture
  // Corners in order, at least three; empty: none. The ball's centre lies inside: what has its
  // centre elsewhere is not the ball, and a ball that has left it is out of view.
  std::vector<PointPx> polygon;
  std::optional<RadiusRange> radius_px;  // of the ball; from the picture's size
  // Frames corrected by hand, each once; those that are not analysed count for nothing. Their
  // circles tell the ball's radius, too: they may be those of another ball than the one found.
  std::vector<BallByHand> ball_at;
  // Which of several balls is measured, by its rank among Inspection::candidates (with the same
  // frames, roi and radius_px); 0: the first, wherever it is taken for.
  int ball = 0;
  Estimator estimator = Estimator::kBall;
  Body body = Body::kAuto;
  FieldOptions field;
  int spacing_px = 0;      // of the windows' centres; 0: half a window, rounded up
  bool with_field = true;  // false: circles alone, no device needed
  // Scale: one of both, or neither for results in px alone, and their standard deviations. With the
  // diameter the scale is that over twice the free ball's radius (ImpactAnalysis::radius_px).
  double ball_diameter_mm = 0, mm_per_px = 0;
  double ball_diameter_sd_mm = 0, mm_per_px_sd = 0;
  // camera.toml of a calibrated camera (camera/model.h); "": none. Coordinates are corrected with
  // it, never pictures. It gives the scale of its plane of motion; where the diameter is given as
  // well, the ball's own size does, wherever it flies.
  std::string camera;
  CameraMotionUse camera_motion = CameraMotionUse::kCorrect;
  // Both counter-clockwise from image-right: the surface's inclination, and where gravity points.
  double surface_angle_deg = 0, gravity_angle_deg = -90;
  double surface_angle_sd_deg = 0;  // standard deviation of the surface's inclination
  double drop_height_mm = 0;        // from which the ball fell, to the touch; 0: not known
  double inertia_factor = 0;        // I / (m R^2): 2/3 hollow, 2/5 solid, 0.01 … 1; 0: not known
  // Of the camera from the ball, for the velocity along the line of sight, and its standard
  // deviation; 0: not known, but for what `camera` tells.
  double distance_mm = 0, distance_sd_mm = 0;
  // Throws InvalidArgument naming the setting, by its name on the command line.
  void validate() const;
};

// When the frames were taken, by the camera's own clock.
struct FrameTimes {
  bool measured = false;     // the file has a time for every frame, and no rate was given instead
  double jitter_s = 0;       // scatter of the times about an even rate
  std::int64_t missing = 0;  // frames that the camera did not store, between others
  std::int64_t missing_after = -1;  // the stored frame before the first of them
};

// Where the still background lies in a picture, against the first picture with a ball: so far from
// there at the picture's middle, and rolled by so much about it, from x towards y.
struct PictureShift {
  bool known = false;
  double x_px = 0, y_px = 0, roll_rad = 0;
  double x_sd_px = kNotMeasured, y_sd_px = kNotMeasured, roll_sd_rad = kNotMeasured;
};

// Of a camera that shakes or pans: its motion as the background shows it.
struct CameraMotion {
  std::vector<PictureShift> of_rows;  // one a row
  std::int64_t frame_step = 1;        // stored frames from one row to the next
  double middle_x_px = 0, middle_y_px = 0;
};

struct TrackResult {
  ClipInfo clip;
  FrameRange frames;           // analysed
  Roi roi;                     // looked at
  std::vector<TrackRow> rows;  // one a frame measured, in order; see TrackFolder::keep_rows
  FrameTimes times;
  SiScale scale;            // for to_si
  Body body = Body::kDisc;  // as which it was measured
  std::string body_reason;  // why, in words
  // Of a sphere, from its turns and its rim; NaN where only its rim told.
  Measured sphere_radius_px;
  // The same over the camera's distance, as it was registered; 0: by parallel rays. What told it:
  // "camera", "distance" (--distance-mm), "pictures", or "nothing".
  Measured sphere_nearness;
  std::string nearness_from;
  double grid_radius_px = 0;  // of the ball that the windows' grid was made for; 0: no grid
  std::size_t windows = 0;    // of that grid
  std::optional<CameraFigures> camera;  // where one was given
  // Where the background shows that the camera moved: rows are what the pictures show, all that
  // follows from them (to_si, impacts, flights) is against the background.
  std::optional<CameraMotion> camera_motion;
  ImpactAnalysis impact;    // in px and frames; corrected px where a camera was given
  ImpactFigures impact_si;  // the same in SI
  // Of a ball that bounces several times: the other impacts, in order of time. `impact` is the
  // sharpest.
  std::vector<ImpactFigures> more_impacts_si;
  ClipAdvice advice;
  std::vector<std::string> warnings;  // one line each
  std::int64_t frames_measured = 0;   // rows, those of an earlier run that was gone on with too
  std::int64_t frames_with_ball = 0;  // rows with a circle
  std::int64_t frames_ok = 0;         // those that have their motion, too; the last one has none
  double seconds = 0;                 // that the measuring took
  double frames_per_s = 0;
  bool cancelled = false;  // `rows` end where the run was stopped
};

// Of one of its rows, with the camera's correction where one was given.
SiRow to_si(const TrackResult& result, std::size_t row);

// One frame as it comes. Everything is valid during the call only.
struct TrackedFrame {
  const TrackRow& row;
  const Frame& picture;    // cut to the result's `roi`
  const FieldView& field;  // towards the next frame; empty where there is none
};
// Called once a frame, in order, from one thread at a time.
using TrackSink = std::function<void(const TrackedFrame&)>;

// Opens the clip, looks at its texture and noise, measures, scales, analyses the impact and
// collects warnings: all that decides a number, the same bits for every caller. Throws
// InvalidArgument before anything is measured; FileError, FormatError, OpenClError, BuildError also
// later.
TrackResult track(const TrackRequest& request, Session& session, const RunControl& control = {},
                  const TrackSink& sink = {});

// The same into `result`, which holds what was measured also where this throws.
void track(const TrackRequest& request, Session& session, const RunControl& control,
           const TrackSink& sink, TrackResult& result);

struct OverlayOptions {
  bool wanted = false;
  double slow_motion = 0;  // how many times slower than life the video plays; 0: 25 frames/s
  double arrow_scale = 0;  // of displacements; 0: by the ball's first motion
};

// What `track_to_folder` writes, and how.
struct TrackFolder {
  std::string folder;
  bool force = false;    // also into a folder that holds files
  bool resume = false;   // go on where an earlier run into the folder ended
  bool checksum = true;  // the clip's SHA-256, which reads all of it once more
  int compression = 0;   // deflate fields.h5 at this level, 1 … 9; 0: not at all
  // False: TrackResult::rows stays empty, and memory does not grow with the clip; but with an
  // overlay or a camera, which need them. The rows are in track.csv.
  bool keep_rows = true;
  OverlayOptions overlay;
  void validate() const;  // throws InvalidArgument
};

// `track` with files: track.csv, pose.csv, fields.h5, summary.json, job.toml, key_frames/ and,
// where wanted, overlay/ and overlay.mp4 (docs/file-formats.md). What was measured before an error,
// or before the run was cancelled, is on the disk. `sink` gets every frame that this run measures,
// after the files have it. Throws also FileError where the disk refuses.
TrackResult track_to_folder(const TrackRequest& request, const TrackFolder& folder,
                            Session& session, const RunControl& control = {},
                            const TrackSink& sink = {});

}  // namespace impactdic
