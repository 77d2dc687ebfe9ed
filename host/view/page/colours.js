// Colour maps that the colour-blind can read and that stay in order when printed grey: viridis and
// cividis, by their values at every 32nd of 256 levels; and the page's colours for lines.
const ANCHORS = {
  viridis: ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"],
  cividis: ["00224e", "1f3b6d", "434e6c", "5e626e", "7d7c78", "9a9275", "bbae6b", "ddcb5a", "fee838"],
};

const parts = hex => [0, 2, 4].map(k => parseInt(hex.slice(k, k + 2), 16));

// "rgb(…)" of a share 0 … 1.
export function colour(share, map = "viridis") {
  const anchors = ANCHORS[map];
  const at = Math.min(1, Math.max(0, share)) * (anchors.length - 1), k = Math.min(anchors.length - 2, Math.floor(at));
  const low = parts(anchors[k]), high = parts(anchors[k + 1]);
  return `rgb(${low.map((v, i) => Math.round(v + (at - k) * (high[i] - v))).join(",")})`;
}

export function paintBar(canvas, map) {
  const context = canvas.getContext("2d");
  for (let x = 0; x < canvas.width; ++x) {
    context.fillStyle = colour(x / (canvas.width - 1), map);
    context.fillRect(x, 0, 1, canvas.height);
  }
}

export const BLUE = "#0072B2", ORANGE = "#E69F00", RED = "#D55E00", SKY = "#56B4E9", YELLOW = "#F0E442", BLACK = "#222";
