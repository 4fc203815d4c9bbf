// SPDX-License-Identifier: Apache-2.0
// WebGL2: programs with what they ask for, targets, and buffers of uniform blocks.
"use strict";

/// The columns and rows of the types that members of uniform blocks have, and whether they are floats.
function shapeOf(gl, type) {
  const shapes = {
    [gl.FLOAT]: [1, 1, true], [gl.FLOAT_VEC2]: [1, 2, true], [gl.FLOAT_VEC3]: [1, 3, true], [gl.FLOAT_VEC4]: [1, 4, true],
    [gl.FLOAT_MAT3]: [3, 3, true], [gl.FLOAT_MAT4]: [4, 4, true], [gl.INT]: [1, 1, false], [gl.BOOL]: [1, 1, false],
  };
  const shape = shapes[type];
  if (!shape) throw new Error(`a uniform has a type that the page does not know: ${type}`);
  return { columns: shape[0], rows: shape[1], isFloat: shape[2] };
}

/// A linked program, its attributes, uniform blocks and samplers.
class Program {
  constructor(gl, { name, vertex, fragment }) {
    this.gl = gl;
    this.name = name;
    this.program = gl.createProgram();
    const shaders = [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]].map(([kind, text]) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
      return shader;
    });
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS)) {
      const log = [...shaders.map((shader) => gl.getShaderInfoLog(shader)), gl.getProgramInfoLog(this.program)];
      throw new Error(`the shader of ${name} does not compile:\n${log.filter((text) => text).join("\n")}`);
    }
    for (const shader of shaders) gl.deleteShader(shader);
    this.attributes = this.list(gl.ACTIVE_ATTRIBUTES, (i) => gl.getActiveAttrib(this.program, i))
      .filter(({ name }) => !name.startsWith("gl_"))
      .map(({ name }) => ({ name, location: gl.getAttribLocation(this.program, name) }));
    this.readUniforms();
  }

  list(count, get) {
    return Array.from({ length: this.gl.getProgramParameter(this.program, count) }, (_, i) => get(i));
  }

  readUniforms() {
    const { gl, program } = this;
    const uniforms = this.list(gl.ACTIVE_UNIFORMS, (i) => gl.getActiveUniform(program, i));
    const indices = uniforms.map((_, i) => i);
    const ask = (parameter) => (indices.length ? gl.getActiveUniforms(program, indices, parameter) : []);
    const [blockOf, offsets] = [ask(gl.UNIFORM_BLOCK_INDEX), ask(gl.UNIFORM_OFFSET)];
    const [arrayStrides, matrixStrides] = [ask(gl.UNIFORM_ARRAY_STRIDE), ask(gl.UNIFORM_MATRIX_STRIDE)];
    this.blocks = this.list(gl.ACTIVE_UNIFORM_BLOCKS, (index) => {
      gl.uniformBlockBinding(program, index, index);
      return {
        index,
        name: gl.getActiveUniformBlockName(program, index),
        size: gl.getActiveUniformBlockParameter(program, index, gl.UNIFORM_BLOCK_DATA_SIZE),
        members: indices.filter((i) => blockOf[i] === index).map((i) => ({
          name: uniforms[i].name, count: uniforms[i].size, offset: offsets[i], arrayStride: arrayStrides[i],
          matrixStride: matrixStrides[i], ...shapeOf(gl, uniforms[i].type),
        })),
      };
    });
    this.uniforms = uniforms.filter((_, i) => blockOf[i] === -1)
      .map(({ name, type, size }) => ({ name, type, size, location: gl.getUniformLocation(program, name) }));
    this.samplers = this.uniforms.filter(({ type }) => type === gl.SAMPLER_2D || type === gl.SAMPLER_2D_ARRAY);
    gl.useProgram(program);
    this.samplers.forEach(({ location }, unit) => gl.uniform1i(location, unit));
  }
}

/// Writes the members of a block. `valueOf` gives the numbers of a member by its name, columns one after the other.
function fillBlock(view, begin, block, valueOf) {
  for (const member of block.members) {
    const numbers = valueOf(member.name);
    if (numbers === undefined) throw new Error(`the page has no value for ${member.name} of ${block.name}`);
    let next = 0;
    for (let item = 0; item < member.count; ++item)
      for (let c = 0; c < member.columns; ++c)
        for (let r = 0; r < member.rows; ++r) {
          const at = begin + member.offset + item * member.arrayStride + c * member.matrixStride + 4 * r;
          const number = numbers[next++] ?? 0;
          if (member.isFloat) view.setFloat32(at, number, true);
          else view.setInt32(at, number, true);
        }
  }
}

/// One buffer of slices, each of which a program may see as a block.
class Slices {
  constructor(gl) {
    this.gl = gl;
    this.align = gl.getParameter(gl.UNIFORM_BUFFER_OFFSET_ALIGNMENT);
    this.size = 0;
    this.buffer = gl.createBuffer();
  }
  /// Returns the first byte of a new slice.
  reserve(bytes) {
    const begin = this.size;
    this.size += Math.ceil(bytes / this.align) * this.align;
    return begin;
  }
  /// After the last slice was reserved.
  get view() {
    this.bytes ??= new ArrayBuffer(this.size);
    return new DataView(this.bytes);
  }
  upload() {
    if (this.size === 0) return;
    this.gl.bindBuffer(this.gl.UNIFORM_BUFFER, this.buffer);
    this.gl.bufferData(this.gl.UNIFORM_BUFFER, this.bytes ?? this.size, this.gl.DYNAMIC_DRAW);
  }
  bind(index, begin, bytes) {
    this.gl.bindBufferRange(this.gl.UNIFORM_BUFFER, index, this.buffer, begin, bytes);
  }
}

/// A texture that is read texel by texel; with `layers` an array.
function makeTexture(gl, format, width, height, levels = 1, layers = undefined) {
  const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
  if (Math.max(width, height) > most)
    throw new Error(`an image has ${width} x ${height} pixels; this browser has room for ${most} a side`);
  const target = layers === undefined ? gl.TEXTURE_2D : gl.TEXTURE_2D_ARRAY;
  const texture = gl.createTexture();
  gl.bindTexture(target, texture);
  if (layers === undefined) gl.texStorage2D(target, levels, format, width, height);
  else gl.texStorage3D(target, levels, format, width, height, layers);
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, levels > 1 ? gl.NEAREST_MIPMAP_NEAREST : gl.NEAREST);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return texture;
}

/// An image that shaders make.
class Target {
  constructor(gl, width, height, colorFormat, hasDepth) {
    Object.assign(this, { gl, width, height });
    this.color = makeTexture(gl, colorFormat, width, height);
    this.depth = hasDepth ? makeTexture(gl, gl.DEPTH_COMPONENT32F, width, height) : null;
    this.framebuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.color, 0);
    if (hasDepth) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.depth, 0);
    if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE)
      throw new Error("this browser cannot draw into images of this format");
  }
  use() {
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, this.framebuffer);
    this.gl.viewport(0, 0, this.width, this.height);
  }
  /// The colours as floats, rows from the top; WebGL counts them from the bottom.
  read() {
    this.use();
    const { gl, width, height } = this;
    const upward = new Float32Array(4 * width * height), rgba = new Float32Array(upward.length);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, upward);
    for (let y = 0; y < height; ++y)
      rgba.set(upward.subarray(4 * width * y, 4 * width * (y + 1)), 4 * width * (height - 1 - y));
    return rgba;
  }
  release() {
    this.gl.deleteFramebuffer(this.framebuffer);
    for (const texture of [this.color, this.depth]) if (texture) this.gl.deleteTexture(texture);
  }
}

/// The program that brings a finished image to the canvas, as runtime/scene/encode.cpp does it for files.
function makeEncoder(gl) {
  const program = new Program(gl, {
    name: "the encoding",
    vertex: `#version 300 es
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
  gl_Position = vec4(corner, 0.0, 1.0);
}`,
    fragment: `#version 300 es
precision highp float;
uniform highp sampler2D image;
uniform float exposure;
uniform bool srgb;
out vec4 encoded;
void main() {
  vec4 color = texelFetch(image, ivec2(gl_FragCoord.xy), 0);
  float divisor = color.a > 0.0 && color.a < 1.0 ? color.a : 1.0;
  vec3 linear = clamp(color.rgb * exposure / divisor, 0.0, 1.0);
  vec3 curved = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
  encoded = vec4(srgb ? mix(curved, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308))) : linear, 1.0);
}`,
  });
  const at = Object.fromEntries(program.uniforms.map(({ name, location }) => [name, location]));
  return (image, { exposure, encoding }) => {
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, image.width, image.height);
    gl.disable(gl.DEPTH_TEST);
    gl.disable(gl.CULL_FACE);
    gl.useProgram(program.program);
    gl.uniform1f(at.exposure, exposure);
    gl.uniform1i(at.srgb, encoding === "srgb");
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, image.color);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  };
}
