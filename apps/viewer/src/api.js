// SPDX-License-Identifier: MIT
//
// api.js: requests to the studio's server (apps/alcap/studio/studio_server.cpp).
import { unpack } from './pack.js';

const token = new URLSearchParams(location.search).get('t') || '';

export class Refused extends Error {
  constructor(status, message) {
    super(message);
    this.status = status;
  }
}

export function address(path, parameters = {}) {
  return `${path}?${new URLSearchParams({ ...parameters, t: token })}`;
}

/** The answer's bytes as a pack, or its JSON, or null where there is none. Throws Refused; a TypeError when nobody answers. */
export async function ask(path, parameters = {}, { body, method = body === undefined ? 'GET' : 'POST', signal } = {}) {
  const response = await fetch(address(path, parameters), { method, body, signal, cache: 'no-store' });
  if (response.status === 204) return null;
  const json = response.headers.get('content-type')?.startsWith('application/json');
  if (!response.ok) throw new Refused(response.status, json ? (await response.json()).error : response.statusText);
  return json ? response.json() : unpack(await response.arrayBuffer());
}
