// Numbers of the sliders: each keeps the form in which the program has it.

export interface Slider {
  least: number;
  most: number;
  step: number;
  decimals: number;
}

// Returns the slider of a number as it is written. One without a decimal point may count increments: it stays whole.
export function sliderOf(word: string): Slider {
  const value = Number(word);
  const reach = Math.max(Math.abs(value), 10);
  const decimals = decimalsOf(word);
  const step = decimals === 0 ? Math.max(1, Math.round(reach / 200)) : reach / 200;
  return { least: value - reach, most: value + reach, step, decimals };
}

// Returns a number in the form of a written one: with a decimal point if that has one, with at least its decimals.
export function numberLike(word: string, value: number): string {
  const text = value.toFixed(decimalsOf(word));
  const form = word.includes(".") ? text.replace(/0+$/, "") : text;
  return /^-0\.?$/.test(form) ? form.slice(1) : form;
}

function decimalsOf(word: string): number {
  const point = word.indexOf(".");
  return point < 0 ? 0 : Math.max(3, word.length - point - 1);
}
