// SPDX-License-Identifier: Apache-2.0
// WebGL2: programs, targets of floats, and waiting for the GPU.

class Gl {
  constructor(canvas) {
    const gl = canvas.getContext('webgl2', { antialias: false, depth: false, powerPreference: 'high-performance' });
    if (!gl) throw new Error('This browser has no WebGL2, which the picture needs.');
    if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('This GPU cannot draw into buffers of floats.');
    this.halves = !gl.getExtension('EXT_float_blend');  // then sums are kept in 16-bit floats
    this.gl = gl;
    this.blank = gl.createVertexArray();
    const text = (id) => document.getElementById(id).textContent;
    const head = '#version 300 es\n', table = text('table_glsl'), light = text('light_glsl');
    const precision = 'precision highp float;\n';
    this.kernel = this.program(text('kernel_vert'), text('kernel_frag'));
    this.hits = this.program(text('boundary_vert'), text('hits_frag'));
    this.solid = this.program(text('boundary_vert'), head + precision + light + text('solid_frag'));
    this.composite = this.program(text('screen_vert'), head + precision + table + text('composite_frag'));
    this.shade = this.program(text('screen_vert'), head + precision + table + light + text('shade_frag'));
    this.show = this.program(text('screen_vert'), text('show_frag'));
    this.targets = new Map();
  }

  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source.trim());
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const uniforms = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
      const { name, type } = gl.getActiveUniform(program, i);
      uniforms[name] = { at: gl.getUniformLocation(program, name), type };
    }
    return { program, uniforms };
  }

  // Uses a program with these uniforms; textures get units in the order in which they stand.
  use({ program, uniforms }, values) {
    const gl = this.gl;
    gl.useProgram(program);
    let unit = 0;
    for (const [name, value] of Object.entries(values)) {
      if (!uniforms[name]) continue;
      const { at, type } = uniforms[name];
      if (type === gl.SAMPLER_2D) {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl.TEXTURE_2D, value);
        gl.uniform1i(at, unit++);
      } else if (type === gl.INT || type === gl.BOOL) {
        gl.uniform1i(at, value);
      } else if (type === gl.FLOAT) {
        gl.uniform1f(at, value);
      } else {
        gl['uniform' + value.length + 'fv'](at, value);
      }
    }
  }

  texture(width, height, format, pixels, old) {
    const gl = this.gl, texture = old || gl.createTexture();
    const [outer, type] = format === gl.RG32F || format === gl.RG16F ? [gl.RG, gl.FLOAT] : [gl.RGBA, gl.FLOAT];
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, outer, type, pixels);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    return texture;
  }

  // A frame buffer with textures of this size; the same one for the same name, made anew when the size changes.
  target(name, width, height, formats, depth = false) {
    const gl = this.gl, old = this.targets.get(name);
    if (old && old.width === width && old.height === height) return old;
    if (old) {
      old.textures.forEach((texture) => gl.deleteTexture(texture));
      if (old.depth) gl.deleteRenderbuffer(old.depth);
      gl.deleteFramebuffer(old.frame);
    }
    const target = { width, height, frame: gl.createFramebuffer(), textures: [] };
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
    formats.forEach((format, i) => {
      const half = { [gl.RGBA32F]: gl.RGBA16F, [gl.RG32F]: gl.RG16F }[format];
      const texture = this.texture(width, height, this.halves ? half : format, null);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, texture, 0);
      target.textures.push(texture);
    });
    if (depth) {
      target.depth = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, target.depth);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, target.depth);
    }
    gl.drawBuffers(formats.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
    this.targets.set(name, target);
    return target;
  }

  bind(target) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, target ? target.frame : null);
    const { width, height } = target || gl.canvas;
    gl.viewport(0, 0, width, height);
  }

  buffer(kind, content) {
    const gl = this.gl, buffer = gl.createBuffer();
    gl.bindBuffer(kind, buffer);
    gl.bufferData(kind, content, gl.STATIC_DRAW);
    return buffer;
  }

  screen() {
    const gl = this.gl;
    gl.bindVertexArray(this.blank);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  // Resolves when the GPU has done all work so far.
  done() {
    const gl = this.gl, fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    return new Promise((resolve) => {
      const look = () => {
        const state = gl.clientWaitSync(fence, 0, 0);
        if (state === gl.TIMEOUT_EXPIRED) {
          setTimeout(look, 2);
        } else {
          gl.deleteSync(fence);
          resolve();
        }
      };
      look();
    });
  }
}
