// Test of the numbers of the sliders: node --test test/slider.mjs
import assert from "node:assert/strict";
import { test } from "node:test";
import { build } from "esbuild";

const entry = new URL("../src/slider.ts", import.meta.url).pathname;
const { outputFiles } = await build({ entryPoints: [entry], bundle: true, format: "esm", write: false });
const { numberLike, sliderOf } = await import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);

test("a number with a point keeps it and its decimals", () => {
  assert.equal(numberLike("20.", 25), "25.");
  assert.equal(numberLike("20.", 20.5), "20.5");
  assert.equal(numberLike("15.2885", 15.2886), "15.2886");
  assert.equal(numberLike("-18.2505", -18.2505), "-18.2505");
  assert.equal(numberLike("-1.", -0.0001), "0.");
});

test("a number without a point gets none", () => {
  assert.equal(numberLike("10", 11), "11");
  assert.equal(numberLike("10", 100), "100");
  assert.equal(numberLike("-1", -0.2), "0");
  assert.equal(sliderOf("10").step, 1);
  assert.equal(sliderOf("1000").step, 5);
});
