// Pictures of the clip: fetched ahead of where one looks, the latest wish first, and kept while
// memory lasts.
import * as server from "./server.js";

const MOST_BYTES = 160e6, AT_ONCE = 4, AHEAD = 24;

export class Frames {
  // `arrived(frame)` is called for each picture that comes; `failed(line)` where one does not.
  constructor(clip, shot, arrived, failed) {
    Object.assign(this, {clip, shot, arrived, failed});
    // Pictures beyond 8 megapixels come as means over blocks of pixels.
    this.shrink = Math.max(1, Math.ceil(Math.sqrt(clip.width * clip.height / 8e6)));
    this.width = Math.floor(clip.width / this.shrink);
    this.height = Math.floor(clip.height / this.shrink);
    this.kept = new Map();  // in the order of use
    this.most = Math.max(AHEAD + 2, Math.floor(MOST_BYTES / (this.width * this.height)));
    this.coming = new Map();
    this.wanted = [];
    this.contrast = [clip.black, clip.white];
  }
  get(frame) {
    const picture = this.kept.get(frame);
    if (picture) { this.kept.delete(frame); this.kept.set(frame, picture); }
    return picture;
  }
  setContrast(black, white) {
    this.contrast = [black, white];
    this.kept.clear();
    for (const abort of this.coming.values()) abort.abort();
  }
  // This picture now; those behind it in the direction of play soon.
  want(frame, direction = 1, ahead = AHEAD) {
    this.wanted = [frame];
    for (let k = 1; k <= ahead; ++k) {
      const next = frame + k * direction;
      if (next >= 0 && next < this.clip.frames) this.wanted.push(next);
    }
    this.pump();
  }
  pump() {
    for (const frame of this.wanted) {
      if (this.coming.size >= AT_ONCE) return;
      if (!this.kept.has(frame) && !this.coming.has(frame)) this.fetch(frame);
    }
  }
  async fetch(frame) {
    const abort = new AbortController();
    this.coming.set(frame, abort);
    const [black, white] = this.contrast;
    const query = {shot: this.shot, frame, black, white, shrink: this.shrink};
    let here = false;
    try {
      this.kept.set(frame, new Uint8Array(await server.bytes("frame", query, abort.signal)));
      if (this.kept.size > this.most) this.kept.delete(this.kept.keys().next().value);
      here = true;
    } catch (error) {
      if (error.name !== "AbortError") {
        this.wanted = this.wanted.filter(other => other !== frame);
        this.failed(error.message);
      }
    }
    this.coming.delete(frame);
    if (here) this.arrived(frame);
    this.pump();
  }
}
