// Plays a scene of kinesic and its voice in step. The page's address names them: index.html?scene=scene.glb&voice=scene.wav
//
// The sound card's clock drives the animation, so that both stay in step however slowly frames are drawn.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const FIELD_OF_VIEW = 28; // [deg] vertical
const FRAME_MARGIN = 1.15; // height of the view / height of the body
const UPPER_FRACTION = 0.62; // fraction of a standing body's height that is shown, from its top

/** Performance of the page; null until its files are loaded. */
export let shown = null;

/** Loads a scene and, if there is one, its voice. */
export async function loadPerformance(sceneUrl, voiceUrl, context) {
  const [gltf, voice] = await Promise.all([
    new GLTFLoader().loadAsync(sceneUrl),
    voiceUrl === null ? null : fetchVoice(voiceUrl, context),
  ]);
  gltf.scene.traverse((node) => {
    node.frustumCulled = false; // a skin's bounds are those of its rest pose
  });
  return new Performance(gltf.scene, gltf.animations[0], voice, context);
}

async function fetchVoice(url, context) {
  const response = await fetch(url);
  if (!response.ok) {
    throw new Error(`${url}: ${response.status} ${response.statusText}`);
  }
  return context.decodeAudioData(await response.arrayBuffer());
}

/** A body that moves and speaks. Second 0 of the animation is second 0 of the voice. */
export class Performance {
  constructor(body, clip, voice, context) {
    this.body = body;
    this.duration = clip.duration;
    this.output = context.destination; // audio node that receives the voice
    this.ended = true;
    this._voice = voice;
    this._context = context;
    this._mixer = new THREE.AnimationMixer(body);
    const action = this._mixer.clipAction(clip);
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.play();
    this._mixer.setTime(0);
  }

  /** Starts motion and voice from their beginning. */
  async start() {
    await this._context.resume(); // browsers hold the clock until the user acts on the page
    this._source?.stop();
    this._begin = this._context.currentTime + 0.1; // [s] ahead, so that the first sample is not late
    this.ended = false;
    if (this._voice !== null) {
      this._source = this._context.createBufferSource();
      this._source.buffer = this._voice;
      this._source.connect(this.output);
      this._source.start(this._begin);
    }
  }

  /** Moves the body to what is heard now, and returns the time [s] since the beginning. */
  update() {
    if (this.ended) {
      return 0;
    }
    const heard = this._context.currentTime - (this._context.outputLatency || 0);
    const time = Math.min(Math.max(heard - this._begin, 0), this.duration);
    this._mixer.setTime(time);
    this.ended = time >= this.duration;
    return time;
  }
}

/** Returns a camera that shows the head and torso of a body, in front of it. */
export function frameBody(body) {
  const box = new THREE.Box3().setFromObject(body);
  const height = box.max.y - box.min.y;
  const shown = height * (height > 1.2 ? UPPER_FRACTION : 1); // [m] robots of the waist up are shown whole
  const camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.05, 50);
  const distance = (FRAME_MARGIN * shown) / 2 / Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
  const middle = new THREE.Vector3(0, box.max.y - shown / 2, 0);
  camera.position.copy(middle).add(new THREE.Vector3(0, 0, distance));
  return { camera, middle };
}

function makeStage(performance) {
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  document.body.append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color("#dfe3e8");
  const key = new THREE.DirectionalLight("white", 2.2);
  key.position.set(-1, 2, 2);
  scene.add(performance.body, key, new THREE.HemisphereLight("white", "#8a8078", 1.6));
  const { camera, middle } = frameBody(performance.body);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.target.copy(middle);
  controls.update();
  const fit = () => {
    renderer.setSize(innerWidth, innerHeight);
    camera.aspect = innerWidth / innerHeight;
    camera.updateProjectionMatrix();
  };
  addEventListener("resize", fit);
  fit();
  renderer.setAnimationLoop(() => {
    performance.update();
    renderer.render(scene, camera);
  });
}

async function openPage() {
  const parameters = new URLSearchParams(location.search);
  const button = document.getElementById("play");
  try {
    const performance = await loadPerformance(
      parameters.get("scene") ?? "scene.glb",
      parameters.get("voice"),
      new AudioContext(),
    );
    makeStage(performance);
    shown = performance;
    button.addEventListener("click", () => performance.start());
    button.disabled = false;
  } catch (error) {
    document.getElementById("message").textContent = String(error);
  }
}

openPage();
