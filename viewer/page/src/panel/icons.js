/** Icons as outlines on a grid of 24. */
const icon = (paths) => `<svg viewBox="0 0 24 24" aria-hidden="true">${paths}</svg>`;

export const ICONS = {
  play: icon('<path class="solid" d="M8 5.5v13l10.5-6.5z"/>'),
  pause: icon('<path d="M9 6v12M15 6v12"/>'),
  step: icon('<path class="solid" d="M6 6v12l8-6z"/><path d="M17.5 6v12"/>'),
  reset: icon('<path d="M5 12a7 7 0 1 0 2.2-5.1M5 4.5v4h4"/>'),
  record: icon('<circle class="solid" cx="12" cy="12" r="5.5"/>'),
  pull: icon('<circle cx="17.5" cy="6.5" r="3"/><path d="M15.3 8.7 5 19M5 14.5V19h4.5"/>'),
  brush: icon('<path d="M19.5 4.5 11 13M8.5 12.5c3 0 4 3.5 1.5 5.5-1.5 1.2-4 1.5-6 1 1.5-1.2 1-6.5 4.5-6.500z"/>'),
  box: icon('<path stroke-dasharray="3 2.6" d="M5 5h14v14H5z"/>'),
  move: icon('<path d="M12 3.500v17M3.5 12h17M9.5 6 12 3.5 14.5 6M9.5 18l2.5 2.5 2.5-2.500M6 9.5 3.5 12 6 14.500M18 9.500l2.5 2.5-2.5 2.5"/>'),
  rotate: icon('<path d="M19 12a7 7 0 1 1-2.2-5.100M19 4.500v4h-4"/>'),
  undo: icon('<path d="M8 5 4 9l4 4M4.5 9H14a5 5 0 0 1 0 10h-3"/>'),
  redo: icon('<path d="m16 5 4 4-4 4M19.5 9H10a5 5 0 0 0 0 10h3"/>'),
  remove: icon('<path d="m7 7 10 10M17 7 7 17"/>'),
  theme: icon('<circle cx="12" cy="12" r="7.5"/><path class="solid" d="M12 4.500a7.5 7.5 0 0 1 0 15z"/>'),
  help: icon('<path d="M9 9.500a3 3 0 1 1 4.5 2.600c-1 .6-1.5 1.2-1.5 2.400M12 17.800v.1"/>'),
  camera: icon('<path d="M4.5 8h3l1.5-2.500h6L16.5 8h3v10.500h-15z"/><circle cx="12" cy="13" r="3.2"/>'),
  frame: icon('<path d="M4.5 9V4.500H9M15 4.500h4.500V9M19.5 15v4.500H15M9 19.500H4.500V15"/><circle cx="12" cy="12" r="2.5"/>'),
  panel: icon('<path d="M4.5 7h15M4.5 12h15M4.5 17h15"/>'),
};
