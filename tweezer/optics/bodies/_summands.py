from tweezer.compiled import named_njit
O={"error_model": "numpy", "inner": True}
@named_njit(**O)
def direction(dbr,dbi,dr,di,dar,dai,br,bi,vr,vi,ar,ai,ubr,ubi,ur,ui,uar,uai,pdr,pdi,pr,pi,pur,pui,al,al_above,be,e1d,e0d,emd,e1,e0,em):
    return (e1d*dbr+e0d*pdr+emd*dar, e1d*dbi+e0d*pdi+emd*dai,
            em*ubr+e0*pur+e1*uar, em*ubi+e0*pui+e1*uai,
            al*br+be*pr+al_above*ar, al*bi+be*pi+al_above*ai)
