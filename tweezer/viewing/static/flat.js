// The picture without WebGL.
export class Flat {}
