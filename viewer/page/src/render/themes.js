/** What the studio is painted with; the panel's colours are in style.css. */
export const THEMES = {
  light: {top: '#f8f9fb', bottom: '#e6e9ee', object: '#8db3da', reference: '#dcae83', lines: '#1d2b3a', grid: '#b9c2cd', shadow: 0.78},
  dark: {top: '#23272e', bottom: '#3a3f48', object: '#8db3da', reference: '#dcae83', lines: '#0a0f16', grid: '#7d8896', shadow: 0.85},
};

/** Red, green and blue of regions, each 0 … 255. */
export const REGION_COLOURS = {
  held: [54, 62, 76],          // by the model
  fixed: [150, 92, 40],        // by a user
  selected: [250, 176, 60],
  handles: [[226, 87, 43], [46, 139, 120], [142, 99, 190], [204, 150, 30], [196, 72, 118], [60, 120, 190]],
  anchors: [96, 106, 120],     // handles that do not move
};
