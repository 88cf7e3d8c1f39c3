import {DataTexture, LinearFilter, RGBAFormat} from 'three';

/**
 * The maps of Supple's own pictures (io/picture/colour.cpp), interpolated in Oklab: lightness grows evenly in the
 * sequential one, and falls evenly to both sides in the diverging one.
 */
const SEQUENTIAL = [[0.30, 0.13, 295], [0.455, 0.12, 258], [0.61, 0.10, 200], [0.765, 0.15, 150], [0.92, 0.17, 104]];

function linearRgb([L, C, degrees]) {
  const hue = degrees * Math.PI / 180, a = C * Math.cos(hue), b = C * Math.sin(hue);
  const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (L - 0.0894841775 * a - 1.2914855480 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s,
  ];
}

/** As colourful as asked, or as a screen allows at this lightness and hue. */
function onScreen([L, C, hue]) {
  const fits = (chroma) => linearRgb([L, chroma, hue]).every((c) => c >= 0 && c <= 1);
  let chroma = C;
  if (!fits(C)) {
    chroma = 0;
    for (let high = C; high - chroma > 1e-4;) {
      const middle = (chroma + high) / 2;
      if (fits(middle)) chroma = middle; else high = middle;
    }
  }
  return linearRgb([L, chroma, hue]);
}

/** @returns {number[]} linear red, green and blue, each 0 … 1 */
export function mapColour(map, share) {
  share = Math.min(1, Math.max(0, share));
  if (map === 'diverging') {
    const side = Math.abs(2 * share - 1);
    return onScreen([0.955 - 0.5 * side ** 1.15, 0.17 * side, share < 0.5 ? 255 : 30]);
  }
  const at = share * (SEQUENTIAL.length - 1), k = Math.min(Math.floor(at), SEQUENTIAL.length - 2);
  return onScreen(SEQUENTIAL[k].map((from, i) => from + (at - k) * (SEQUENTIAL[k + 1][i] - from)));
}

/** @returns {string} a colour for style sheets */
export function cssColour(map, share) {
  const encode = (c) => Math.round(255 * Math.min(1, Math.max(0, c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055)));
  return `rgb(${mapColour(map, share).map(encode).join(' ')})`;
}

/** Both maps as a texture of two rows, the sequential one first. */
export function colourTexture() {
  const width = 256, texels = new Float32Array(4 * 2 * width);
  for (const [row, map] of ['sequential', 'diverging'].entries())
    for (let k = 0; k < width; ++k) texels.set([...mapColour(map, k / (width - 1)), 1], 4 * (row * width + k));
  const bytes = Uint8Array.from(texels, (c) => Math.round(255 * Math.sqrt(Math.max(0, Math.min(1, c)))));
  const texture = new DataTexture(bytes, width, 2, RGBAFormat);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
