// Dark or light: as the system has it, until somebody says otherwise.
import { byId } from './dom.js';

const KEPT = 'mortise.theme';

export function makeTheme() {
  const light = matchMedia('(prefers-color-scheme: light)');
  const apply = () => {
    document.documentElement.dataset.theme = localStorage.getItem(KEPT) ?? (light.matches ? 'light' : 'dark');
  };
  light.addEventListener('change', apply);
  byId('do_theme').onclick = () => {
    localStorage.setItem(KEPT, document.documentElement.dataset.theme === 'light' ? 'dark' : 'light');
    apply();
  };
  apply();
}
