// The unfolding: a slider over the frames, and playing them.
import { byId, number } from './dom.js';

const step_names = {
  start: 'start', sweep: 'sweep', newton: 'Newton step', iteration: 'iteration', end: 'end',
};

function captionOf(frame, i, count, last_level) {
  const parts = [`Frame ${i + 1} of ${count}`];
  if (Number.isFinite(frame.level) && last_level > 0) {
    parts.push(`level ${frame.level} of ${last_level}${frame.level === 0 ? ' (finest)' : ''}`);
  }
  if (Number.isFinite(frame.nodes)) parts.push(`${number(frame.nodes)} nodes`);
  const step = step_names[frame.step] ?? String(frame.step ?? '');
  const counts = ['sweep', 'newton', 'iteration'].includes(frame.step);
  if (step) parts.push(counts && Number.isFinite(frame.iteration)
    ? `${step} ${number(frame.iteration)}` : step);
  if (Number.isFinite(frame.residual)) parts.push(`residual ${number(frame.residual, 3)}`);
  return parts.join(' · ');
}

export class Player {
  /** `changed(frame or null)` is told of whole frames, null: the result is shown. */
  constructor(views, frames, changed) {
    this.views = views;
    this.frames = frames;
    this.changed = changed;
    this.at = frames.length; // the slider's last place is the result
    this.playing = false;
    this.last_level = Math.max(0, ...frames.map((frame) => frame.level).filter(Number.isFinite));
    this.slider = byId('frame');
    this.button = byId('play');
    this.slider.max = String(frames.length);
    this.slider.value = this.slider.max;
    this.slider.addEventListener('input', () => {
      this.pause();
      this.show(Number(this.slider.value));
    });
    this.button.addEventListener('click', () => (this.playing ? this.pause() : this.play()));
    byId('result').addEventListener('click', () => {
      this.pause();
      this.show(this.frames.length);
    });
    this.show(this.at);
  }

  show(at) {
    this.at = at;
    const count = this.frames.length;
    const whole = Math.min(Math.round(at), count);
    const is_result = at > count - 1 && whole === count;
    this.slider.value = String(whole);
    this.views.setFrame(is_result ? null : Math.min(at, count - 1));
    const caption = is_result ? 'Result'
      : captionOf(this.frames[Math.min(whole, count - 1)], Math.min(whole, count - 1), count,
        this.last_level);
    byId('caption').textContent = caption;
    this.slider.setAttribute('aria-valuetext', caption);
    byId('result').disabled = is_result;
    const shown = is_result ? null : Math.min(whole, count - 1);
    if (shown !== this.shown) {
      this.shown = shown;
      this.changed(shown);
    }
  }

  play() {
    this.playing = true;
    this.label();
    if (this.at >= this.frames.length - 1) this.show(0);
    // About ten seconds for all, if that is neither a slide show nor a blur.
    const pace = Math.min(Math.max(this.frames.length / 10, 1.5), 10);
    let before = null;
    const step = (now) => {
      if (!this.playing) return;
      const passed = before === null ? 0 : Math.min((now - before) / 1000, 0.1);
      before = now;
      const at = this.at + pace * passed;
      if (at >= this.frames.length) {
        this.show(this.frames.length);
        this.pause();
        return;
      }
      this.show(at);
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  pause() {
    this.playing = false;
    this.label();
  }

  label() {
    this.button.textContent = this.playing ? '❚❚ Pause' : '▶ Play';
    this.button.setAttribute('aria-pressed', String(this.playing));
  }
}
