// Makes the page of -report: node build.mjs OUT.html [LICENCES.txt]
// Everything goes into one file: the script is bundled, deflated and stored as text.
import { build, transform } from 'esbuild';
import { createHash } from 'node:crypto';
import { readFile, writeFile } from 'node:fs/promises';
import { deflateSync } from 'node:zlib';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const folder = dirname(fileURLToPath(import.meta.url));
const [page_file, licences_file] = process.argv.slice(2);
if (!page_file) {
  console.error('usage: node build.mjs OUT.html [LICENCES.txt]');
  process.exit(2);
}

const text = (...parts) => readFile(join(folder, ...parts), 'utf8');
const three = JSON.parse(await text('node_modules', 'three', 'package.json'));
const licence = (await text('node_modules', 'three', 'LICENSE')).trim();

// Browsers that have DecompressionStream and WebGL 2.
const target = ['chrome90', 'firefox113', 'safari16.4'];
const bundled = await build({
  entryPoints: [join(folder, 'src', 'main.js')],
  bundle: true, minify: true, format: 'iife', target, charset: 'ascii', write: false,
  legalComments: 'none', logLevel: 'warning', absWorkingDir: folder,
});
const banner = `/* three.js ${three.version}\n${licence.replaceAll('*/', '* /')}\n*/\n`;
const script = banner + bundled.outputFiles[0].text;
const loader = (await transform(await text('src', 'loader.js'),
  { minify: true, charset: 'ascii', target: 'es2017' })).code.trim();
const style = (await transform(await text('style.css'), { loader: 'css', minify: true, target }))
  .code.trim();

const hash = (code) => `'sha256-${createHash('sha256').update(code, 'utf8').digest('base64')}'`;
const escaped = (words) => words.replaceAll('&', '&amp;').replaceAll('<', '&lt;');
const parts = {
  SCRIPT_HASHES: `${hash(loader)} ${hash(script)}`,
  STYLE: style,
  THREE_VERSION: escaped(three.version),
  THREE_LICENSE: escaped(licence),
  BUNDLE: deflateSync(Buffer.from(script), { level: 9 }).toString('base64'),
  LOADER: loader,
};
const template = await text('page.html');
const page = template.replace(/%([A-Z_]+)%/g, (whole, name) => parts[name] ?? whole);
if (page.split('<!--DATA-->').length !== 2) throw new Error('the page needs one <!--DATA-->');
if (/<\/script/i.test(loader) || /<\/style/i.test(style)) {
  throw new Error('a part ends its element');
}

await writeFile(page_file, page);
if (licences_file) {
  await writeFile(licences_file,
    `The page of -report holds three.js ${three.version} (https://threejs.org).\n\n${licence}\n`);
}
