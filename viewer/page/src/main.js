import {App} from './app.js';
import {embeddedRecording} from './export/standalone.js';
import {exposeHook} from './hook.js';
import {LiveSession} from './session/live_session.js';
import {RecordedSession} from './session/recorded_session.js';

const recording = await embeddedRecording();
const session = recording ? new RecordedSession(recording) : new LiveSession(location);
exposeHook(new App(document.getElementById('app'), session));
