// Drives a report in headless Chromium: node check_report.mjs REPORT.html [CHROMIUM [SCREENSHOTS]]. Needs `npm install` here and
// apt's chromium-headless-shell. Exit code 1 if anything does not do what it should.
import assert from 'node:assert';
import path from 'node:path';
import {chromium} from 'playwright-core';

const [file, executablePath = '/usr/bin/chromium-headless-shell', pictures] = process.argv.slice(2);
const args = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const browser = await chromium.launch({executablePath, args});
for (const [width, height] of [[1280, 960], [390, 844]]) {
  const page = await browser.newPage({viewport: {width, height}});
  const faults = [];
  page.on('console', (message) => { if (message.type() === 'error') faults.push(message.text()); });
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) faults.push(request.url()); });
  const shot = async (name) => { if (pictures) await page.screenshot({path: `${pictures}-${width}-${name}.png`}); };
  const scene = async () => { await page.waitForTimeout(250); return (await page.locator('#canvas').screenshot()).toString('base64'); };
  const begin = Date.now();
  await page.goto('file://' + path.resolve(file));
  await page.waitForSelector('body[data-ready]');
  console.log(`${width}x${height}: ready in ${Date.now() - begin} ms`);
  const answer = await scene();
  await shot('answer');

  await page.focus('#slider');
  await page.keyboard.press('Home');
  assert.equal(await page.textContent('#frame'), 'as given');
  const given = await scene();
  assert.notEqual(given, answer, 'the slider moves nothing');
  await page.keyboard.press('End');
  assert.notEqual(await page.textContent('#frame'), 'as given');

  const before = await scene();
  await page.click('#contacts tr');
  assert.notEqual(await scene(), before, 'the camera does not go to the contact');
  await shot('contact');
  await page.click('#dark');
  assert.equal(await page.getAttribute('html', 'data-theme'), 'dark');
  await shot('dark');
  await page.click('#dark');

  if (await page.isVisible('#filter')) {
    const rows = await page.locator('#rows tr').count();
    await page.fill('#filter', '1');
    assert.ok(await page.locator('#rows tr').count() < rows, 'the filter leaves all rows');
    await page.selectOption('#sort', 'depth');
    await page.click('#rows tr');
  }
  const session = await page.context().newCDPSession(page);
  await session.send('Emulation.setEmulatedVisionDeficiency', {type: 'deuteranopia'});
  await page.evaluate(() => scrollTo(0, 0));
  await scene();
  await shot('deuteranopia');
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), width, 'wider than the screen');
  assert.deepEqual(faults, []);
  await page.close();
}
await browser.close();
