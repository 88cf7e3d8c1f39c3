import {defineConfig} from 'vite';

export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    sourcemap: false,
    modulePreload: false,
    // One script and one style sheet, which a standalone page takes into itself.
    cssCodeSplit: false,
    rollupOptions: {output: {inlineDynamicImports: true, entryFileNames: 'page.js', assetFileNames: 'page[extname]'}},
    chunkSizeWarningLimit: 1200,
  },
});
